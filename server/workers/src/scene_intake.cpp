#include "raykiln/workers/scene_intake.hpp"

#include <system_error>

#include "blob_scene_files.hpp"
#include "import_errors.hpp"
#include "raykiln/io/import.hpp"
#include "raykiln/workers/archive.hpp"

namespace raykiln::server {
namespace {

/// Removes a directory with everything in it.
class ScratchDirectory {
 public:
  explicit ScratchDirectory(std::filesystem::path path) : path_(std::move(path)) {}
  ~ScratchDirectory() {
    std::error_code ignored;  // what stays is removed at the next start of the store
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

class FileIntake final : public SceneIntake {
 public:
  FileIntake(const UploadLimits& limits, std::function<Result<std::filesystem::path>()> scratch)
      : limits_(limits), scratch_(std::move(scratch)) {}

  Result<LoadedScene> load(SceneKind kind, const std::vector<BlobFile>& files,
                           std::stop_token stop) override {
    if (files.empty()) return Error{ErrorKind::kInvalid, "scene_empty", "there is no file", ""};
    if (kind == SceneKind::kFiles) return import(files, std::move(stop));
    if (kind == SceneKind::kGlb) {
      return import({{"scene.glb", files.front().path, files.front().bytes}}, std::move(stop));
    }
    auto made = scratch_();
    if (!made) return made.error();
    const ScratchDirectory scratch(std::move(*made));
    const auto unpacked = unpack_zip(files.front().path, scratch.path(), limits_, stop);
    if (!unpacked) return unpacked.error();
    return import(*unpacked, std::move(stop));
  }

 private:
  static Result<LoadedScene> import(const std::vector<BlobFile>& files, std::stop_token stop) {
    render::ImportOptions options;
    options.stop = std::move(stop);
    auto result = render::import_scene(BlobSceneFiles(files), options);
    if (const auto* error = std::get_if<render::ImportError>(&result)) return to_error(*error);
    auto& imported = std::get<render::ImportedScene>(result);
    SceneReport report = to_report(imported.scene, imported.report);
    return LoadedScene{std::make_shared<const render::Scene>(std::move(imported.scene)),
                       std::move(report)};
  }

  UploadLimits limits_;
  std::function<Result<std::filesystem::path>()> scratch_;
};

}  // namespace

std::unique_ptr<SceneIntake> make_scene_intake(
    const UploadLimits& limits, std::function<Result<std::filesystem::path>()> scratch) {
  return std::make_unique<FileIntake>(limits, std::move(scratch));
}

}  // namespace raykiln::server
