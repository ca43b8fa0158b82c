#include "sidecar.hpp"

#include <algorithm>
#include <vector>

#include "environment.hpp"
#include "material_mapping.hpp"
#include "raykiln/scene/camera.hpp"
#include "scene_file_names.hpp"
#include "sidecar_lights.hpp"

namespace raykiln::render::io {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kLargestWeight = 1e6;
constexpr double kSmallestAngleDeg = 1e-4;
constexpr double kLargestAngleDeg = 179.9;
constexpr double kSmallestLength = 1e-15, kLargestLength = 1e15;

bool read_camera(const JsonAt& at, std::vector<DraftCamera>& cameras) {
  if (!at.expect_object() || !at.only({"name", "eye", "look_at", "up", "fov_deg", "view_height",
                                       "lens_radius", "focus_distance"})) {
    return false;
  }
  if (at.has("fov_deg") && at.has("view_height")) {
    return at.fail(ImportErrorCode::kInvalidValue, "fov_deg and view_height exclude each other",
                   "view_height makes an orthographic camera, which has no angle");
  }
  DraftCamera camera;
  camera.name = clean_text(at.text_or("name", "camera " + std::to_string(cameras.size() + 1)));
  camera.eye = required_point(at, "eye");
  camera.forward = required_point(at, "look_at") - camera.eye;
  camera.up = at.vec3_or("up", Vec3d(0.0, 1.0, 0.0));
  camera.fov_y_rad = at.number_in("fov_deg", 40.0, kSmallestAngleDeg, kLargestAngleDeg) * kDegree;
  if (at.has("view_height")) camera.view_height = at.number_in("view_height", 1.0, kSmallestLength, kLargestLength);
  camera.lens_radius = at.number_in("lens_radius", 0.0, 0.0, kLargestLength);
  camera.focus_distance = length(camera.forward);
  if (at.has("focus_distance")) {
    camera.focus_distance = at.number_in("focus_distance", 1.0, kSmallestLength, kLargestLength);
  }
  if (at.diagnostics().failed()) return false;
  if (!make_camera("", camera.eye, camera.forward, camera.up, camera.fov_y_rad, Vec3d(0.0))) {
    return at.fail(ImportErrorCode::kInvalidValue,
                   "eye and look_at coincide, or up points along the view",
                   "choose another look_at or up");
  }
  cameras.push_back(std::move(camera));
  return true;
}

bool read_cameras(const JsonAt& root, SceneDraft& draft) {
  std::vector<DraftCamera> cameras;
  if (const auto one = root.find("camera"); one && !read_camera(*one, cameras)) return false;
  if (const auto many = root.array("cameras")) {
    if (many->size() > root.diagnostics().limits().max_cameras) {
      return many->fail(ImportErrorCode::kLimitExceeded, "too many cameras");
    }
    for (std::size_t i = 0; i < many->size(); ++i) {
      if (!read_camera(many->element(i), cameras)) return false;
    }
  }
  draft.cameras.insert(draft.cameras.begin(), cameras.begin(), cameras.end());
  return !root.diagnostics().failed();
}

bool override_material(const JsonAt& at, Material& material) {
  if (!at.expect_object() || !at.only({"diffuse", "specular", "transparent", "specular_exp",
                                       "index_of_refraction", "emission"})) {
    return false;
  }
  const double bright = at.diagnostics().limits().max_radiance;
  const auto color = [&](const char* key, Rgb& value, double most) {
    if (at.has(key)) value = Rgb(at.vec3_in(key, Vec3d(0.0), 0.0, most));
  };
  const auto number = [&](const char* key, auto& value, double least, double most) {
    if (at.has(key)) {
      value = static_cast<std::decay_t<decltype(value)>>(at.number_in(key, least, least, most));
    }
  };
  color("diffuse", material.diffuse, kLargestWeight);
  color("specular", material.specular, kLargestWeight);
  color("emission", material.emission, bright);
  number("transparent", material.transparent, 0.0, 1.0);
  number("specular_exp", material.specular_exp, 0.0, 1e15);
  number("index_of_refraction", material.index_of_refraction, 1e-3, 1e20);
  return !at.diagnostics().failed();
}

// The sidecar speaks of the seed's model: a material with microfacets becomes one of that, unless nothing but its
// emission is changed.
void start_from_phong(const JsonAt& at, std::uint32_t id, MaterialTable& table) {
  const auto phong = table.as_phong.find(id);
  if (phong == table.as_phong.end()) return;
  for (const char* key : {"diffuse", "specular", "transparent", "specular_exp", "index_of_refraction"}) {
    if (at.has(key)) table.materials[id] = phong->second;
  }
}

bool read_materials(const JsonAt& root, SceneDraft& draft) {
  const auto materials = root.object("materials");
  if (!materials) return !root.diagnostics().failed();
  for (const std::string& key : materials->keys()) {
    const JsonAt at = materials->member(key);
    Material ignored;
    if (!draft.materials.contains(key)) {
      // Still read, so that mistakes in it are found.
      if (!override_material(at, ignored)) return false;
      at.warn(ImportWarningCode::kUnknownMaterial, "no face uses a material called " + in_quotes(key));
      continue;
    }
    const std::uint32_t id = draft.materials.intern(key);
    start_from_phong(at, id, draft.materials);
    if (!override_material(at, draft.materials.materials[id])) return false;
    draft.materials.defined[id] = true;
  }
  return true;
}

}  // namespace

std::optional<JsonDocument> read_sidecar(const SceneFiles& files, const std::string& name,
                                         Diagnostics& diagnostics) {
  const auto text = read_whole(files, name, diagnostics.limits().max_json_bytes, diagnostics);
  if (!text) return std::nullopt;
  auto document = JsonDocument::parse(*text, name, diagnostics);
  if (!document || !document->root().expect_object()) return std::nullopt;
  if (!document->root().only({"$schema", "scene", "scale", "camera", "cameras", "point_lights",
                              "spot_lights", "directional_lights", "background", "environment",
                              "allow_missing",
                              "materials"})) {
    return std::nullopt;
  }
  return document;
}

bool apply_sidecar(const SceneFiles& files, const JsonAt& root, SceneDraft& draft) {
  draft.metres_per_unit = root.number_in("scale", 1.0, 1e-12, 1e12);
  if (root.has("background")) {
    draft.background = root.vec3_in("background", Vec3d(0.0), 0.0,
                                    root.diagnostics().limits().max_radiance);
  }
  return !root.diagnostics().failed() && read_cameras(root, draft) &&
         read_sidecar_lights(root, draft) && read_environment(files, root, draft) &&
         read_materials(root, draft);
}

}  // namespace raykiln::render::io
