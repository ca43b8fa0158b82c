#include "load_here.hpp"

#include "raykiln/workers/import_files.hpp"
#include "scratch.hpp"

namespace raykiln::server {
namespace {

/// What the user's own machine holds needs no bound against strangers, only the importer's.
UploadLimits own_files() {
  UploadLimits limits;
  limits.max_unpacked_bytes = UINT64_MAX;
  return limits;
}

MissingTextures missing_textures(const ScenePackage& package) {
  return package.allow_missing ? MissingTextures::kLeaveOut : MissingTextures::kRefuse;
}

}  // namespace

Result<LoadedScene> load_here(const ScenePackage& package) {
  const Scratch scratch;
  const auto intake = make_scene_intake(
      own_files(), [&scratch] { return Result<std::filesystem::path>(scratch.path()); });
  return intake->load(package.kind, package.files, missing_textures(package), {});
}

Result<LoadedScene> load_here(const std::filesystem::path& scene, bool allow_missing) {
  auto package = find_scene_files(scene);
  if (!package) return package.error();
  package->allow_missing = allow_missing;
  return load_here(*package);
}

Result<render::ImportResult> import_here(const std::filesystem::path& scene) {
  const auto package = find_scene_files(scene);
  if (!package) return package.error();
  const Scratch scratch;
  return import_files(
      package->kind, package->files, own_files(), missing_textures(*package),
      [&scratch] { return Result<std::filesystem::path>(scratch.path()); }, {});
}

}  // namespace raykiln::server
