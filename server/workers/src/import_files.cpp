#include "raykiln/workers/import_files.hpp"

#include <system_error>

#include "blob_scene_files.hpp"
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

render::ImportResult import_plain(const std::vector<BlobFile>& files, MissingTextures missing,
                                  std::stop_token stop) {
  render::ImportOptions options;
  options.allow_missing = missing == MissingTextures::kLeaveOut;
  options.stop = std::move(stop);
  return render::import_scene(BlobSceneFiles(files), options);
}

}  // namespace

Result<render::ImportResult> import_files(SceneKind kind, const std::vector<BlobFile>& files,
                                          const UploadLimits& limits, MissingTextures missing,
                                          const std::function<Result<std::filesystem::path>()>& scratch,
                                          std::stop_token stop) {
  if (files.empty()) return Error{ErrorKind::kInvalid, "scene_empty", "there is no file", ""};
  if (kind == SceneKind::kFiles) return import_plain(files, missing, std::move(stop));
  if (kind == SceneKind::kGlb) {
    return import_plain({{"scene.glb", files.front().path, files.front().bytes}}, missing,
                        std::move(stop));
  }
  auto made = scratch();
  if (!made) return made.error();
  const ScratchDirectory directory(std::move(*made));
  const auto unpacked = unpack_zip(files.front().path, directory.path(), limits, stop);
  if (!unpacked) return unpacked.error();
  return import_plain(*unpacked, missing, std::move(stop));
}

}  // namespace raykiln::server
