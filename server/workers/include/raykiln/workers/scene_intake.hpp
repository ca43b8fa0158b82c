// From the bytes of an upload to a validated scene.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/scene/scene.hpp"
#include "raykiln/store/store.hpp"
#include "raykiln/workers/import_files.hpp"
#include "raykiln/workers/scene_report.hpp"

namespace raykiln::server {

struct LoadedScene {
  std::shared_ptr<const render::Scene> scene;
  SceneReport report;
};

/// Reads the files of an upload or of a stored scene. Behind an interface so that the scheduler can
/// be tested without files. Safe to use from several threads.
class SceneIntake {
 public:
  virtual ~SceneIntake() = default;
  /// Errors of the input are kInvalid, kUnsupported or kTooLarge: scene_invalid, scene_unsupported,
  /// scene_empty, scene_too_large and those of unpack_zip; `where` = "file", "file:12" or
  /// "file:/json/pointer". kUnavailable "import_stopped" after a stop.
  /// Nothing that was unpacked stays behind. A scene that was taken once is always taken with
  /// kLeaveOut: either nothing was missing, or leaving it out was asked for.
  [[nodiscard]] virtual Result<LoadedScene> load(SceneKind kind, const std::vector<BlobFile>& files,
                                                 MissingTextures missing, std::stop_token stop) = 0;
};

/// The real one. `scratch` makes a private directory to unpack into (Store::scratch_directory).
[[nodiscard]] std::unique_ptr<SceneIntake> make_scene_intake(
    const UploadLimits& limits, std::function<Result<std::filesystem::path>()> scratch);

}  // namespace raykiln::server
