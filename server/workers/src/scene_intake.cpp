#include "raykiln/workers/scene_intake.hpp"

#include "import_errors.hpp"
#include "raykiln/effects/scene_use.hpp"
#include "raykiln/workers/import_files.hpp"

namespace raykiln::server {
namespace {

class FileIntake final : public SceneIntake {
 public:
  FileIntake(const UploadLimits& limits, std::function<Result<std::filesystem::path>()> scratch)
      : limits_(limits), scratch_(std::move(scratch)) {}

  Result<LoadedScene> load(SceneKind kind, const std::vector<BlobFile>& files,
                           MissingTextures missing, std::stop_token stop) override {
    auto result = import_files(kind, files, limits_, missing, scratch_, std::move(stop));
    if (!result) return result.error();
    if (const auto* error = std::get_if<render::ImportError>(&*result)) return to_error(*error);
    auto& imported = std::get<render::ImportedScene>(*result);
    render::drop_unused(imported.scene);
    SceneReport report = to_report(imported.scene, imported.report);
    return LoadedScene{std::make_shared<const render::Scene>(std::move(imported.scene)),
                       std::move(report)};
  }

 private:
  UploadLimits limits_;
  std::function<Result<std::filesystem::path>()> scratch_;
};

}  // namespace

std::unique_ptr<SceneIntake> make_scene_intake(
    const UploadLimits& limits, std::function<Result<std::filesystem::path>()> scratch) {
  return std::make_unique<FileIntake>(limits, std::move(scratch));
}

}  // namespace raykiln::server
