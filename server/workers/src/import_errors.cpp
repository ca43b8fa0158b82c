#include "import_errors.hpp"

#include "raykiln/jobs/job_request.hpp"
#include "raykiln/render/render.hpp"
#include "raykiln/workers/effects.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kMaxNames = 1000;

struct Kind {
  ErrorKind kind;
  const char* code;
};

Kind kind_of(render::ImportErrorCode code) {
  using enum render::ImportErrorCode;
  switch (code) {
    case kNoSceneFile:
    case kAmbiguousScene:
    case kUnsupportedEncoding:
    case kUnsupportedVersion:
    case kUnsupportedExtension: return {ErrorKind::kUnsupported, "scene_unsupported"};
    case kEmptyScene: return {ErrorKind::kInvalid, "scene_empty"};
    case kFileTooLarge:
    case kLimitExceeded: return {ErrorKind::kTooLarge, "scene_too_large"};
    case kUnsafeFileName: return {ErrorKind::kInvalid, "unsafe_name"};
    case kStopped: return {ErrorKind::kUnavailable, "import_stopped"};
    default: return {ErrorKind::kInvalid, "scene_invalid"};
  }
}

/// "box.mtl" and "line 7" -> "box.mtl:7"; "a.gltf" and "/meshes/0" -> "a.gltf:/meshes/0".
std::string place(const std::string& file, const std::string& where) {
  static constexpr std::string_view kLine = "line ";
  const std::string spot = where.starts_with(kLine) ? where.substr(kLine.size()) : where;
  if (file.empty() || spot.empty()) return file + spot;
  return file + ':' + spot;
}

std::array<double, 3> world(const render::Vec3d& origin, const render::Vec3f& local) {
  const render::Vec3d p = origin + render::Vec3d(local);
  return {p.x, p.y, p.z};
}

bool emits(const render::Material& material) {
  return material.emission.x > 0.0F || material.emission.y > 0.0F || material.emission.z > 0.0F;
}

std::uint64_t emissive_triangles(const render::Scene& scene) {
  std::uint64_t count = 0;
  for (const std::uint32_t id : scene.mesh.material_ids) count += emits(scene.materials[id]) ? 1U : 0U;
  return count;
}

/// What a job calls for that names no settings.
EffectReport default_effects(const render::Scene& scene) {
  render::RenderSettings settings;
  settings.max_depth = depth_limit(JobRequest{});
  return effect_report(render::effect_plan(settings, scene));
}

}  // namespace

Error to_error(const render::ImportError& error) {
  const Kind kind = kind_of(error.code);
  std::string message = error.message;
  if (!error.remedy.empty()) message += "; " + error.remedy;
  return {kind.kind, kind.code, message, place(error.file, error.where)};
}

SceneReport to_report(const render::Scene& scene, const render::ImportReport& imported) {
  SceneReport report;
  report.format = name(imported.format);
  report.root_file = imported.root_file;
  report.triangles = scene.mesh.triangles.size();
  report.dropped_triangles = imported.zero_area_triangles;
  report.material_count = scene.materials.size();
  for (const auto& material : scene.materials) {
    if (report.materials.size() < kMaxNames) report.materials.push_back(material.name);
  }
  report.object_count = scene.object_names.size();
  for (const auto& object : scene.object_names) {
    if (report.objects.size() < kMaxNames) report.objects.push_back(object);
  }
  report.point_lights = scene.point_lights.size();
  report.spot_lights = scene.spot_lights.size();
  report.directional_lights = scene.directional_lights.size();
  report.environment = scene.environment != nullptr;
  report.emissive_triangles = emissive_triangles(scene);
  for (const auto& camera : scene.cameras) report.cameras.push_back(camera.name);
  report.bounds_min = world(scene.origin, scene.bounds.lo);
  report.bounds_max = world(scene.origin, scene.bounds.hi);
  report.effects = default_effects(scene);
  for (const render::ImportWarning& warning : imported.warnings) {
    report.warnings.push_back({std::string(name(warning.code)), warning.message, warning.file,
                               place(warning.file, warning.where), warning.count});
  }
  return report;
}

}  // namespace raykiln::server
