#include "sidecar_lights.hpp"

#include <string>

namespace raykiln::render::io {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct KindOfList {
  const char* list;
  LightKind kind;
  const char* power;
  const char* label;
};

bool missing(const JsonAt& at, const char* key) {
  return at.fail(ImportErrorCode::kMissingField, "the field " + in_quotes(key) + " is missing");
}

bool only_known(const JsonAt& at, LightKind kind) {
  switch (kind) {
    case LightKind::kPoint: return at.only({"name", "position", "intensity", "range"});
    case LightKind::kSpot:
      return at.only({"name", "position", "intensity", "range", "direction", "inner_deg",
                      "outer_deg"});
    case LightKind::kDirectional: return at.only({"name", "direction", "irradiance"});
  }
  return false;
}

bool read_direction(const JsonAt& at, Vec3d& direction) {
  if (!at.has("direction")) return missing(at, "direction");
  direction = at.vec3_in("direction", direction, -1e15, 1e15);
  if (at.diagnostics().failed()) return false;
  if (dot(direction, direction) >= 1e-30) return true;
  return at.member("direction").fail(ImportErrorCode::kInvalidValue, "the direction has no length");
}

bool read_cone(const JsonAt& at, DraftLight& light) {
  light.outer_rad = at.number_in("outer_deg", 45.0, 1e-4, 180.0) * kDegree;
  light.inner_rad = at.number_in("inner_deg", 0.0, 0.0, 180.0) * kDegree;
  if (at.diagnostics().failed()) return false;
  if (light.inner_rad <= light.outer_rad) return true;
  return at.fail(ImportErrorCode::kInvalidValue, "inner_deg is above outer_deg");
}

bool read_light(const JsonAt& at, const KindOfList& of, DraftLight& light) {
  light.kind = of.kind;
  if (of.kind != LightKind::kDirectional) light.position = required_point(at, "position");
  if (at.diagnostics().failed()) return false;
  if (!at.has(of.power)) return missing(at, of.power);
  light.power = at.vec3_in(of.power, Vec3d(0.0), 0.0, at.diagnostics().limits().max_radiance);
  if (at.has("range")) light.range = at.number_in("range", 1.0, 1e-15, 1e30);
  if (of.kind != LightKind::kPoint && !read_direction(at, light.direction)) return false;
  if (of.kind == LightKind::kSpot && !read_cone(at, light)) return false;
  return !at.diagnostics().failed();
}

bool read_list(const JsonAt& root, const KindOfList& of, SceneDraft& draft) {
  const auto list = root.array(of.list);
  if (!list) return !root.diagnostics().failed();
  if (draft.lights.size() + list->size() > root.diagnostics().limits().max_lights) {
    return list->fail(ImportErrorCode::kLimitExceeded, "too many lights");
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const JsonAt at = list->element(i);
    if (!at.expect_object() || !only_known(at, of.kind)) return false;
    DraftLight light;
    light.name = clean_text(at.text_or("name", of.label + std::to_string(i + 1)));
    if (!read_light(at, of, light)) return false;
    draft.lights.push_back(std::move(light));
  }
  return true;
}

}  // namespace

Vec3d required_point(const JsonAt& at, const char* key) {
  if (!at.has(key)) {
    missing(at, key);
    return Vec3d(0.0);
  }
  const double limit = at.diagnostics().limits().max_coordinate;
  return at.vec3_in(key, Vec3d(0.0), -limit, limit);
}

bool read_sidecar_lights(const JsonAt& root, SceneDraft& draft) {
  return read_list(root, {"point_lights", LightKind::kPoint, "intensity", "light "}, draft) &&
         read_list(root, {"spot_lights", LightKind::kSpot, "intensity", "spot "}, draft) &&
         read_list(root, {"directional_lights", LightKind::kDirectional, "irradiance", "sun "},
                   draft);
}

}  // namespace raykiln::render::io
