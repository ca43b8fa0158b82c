#include "gltf_lights.hpp"

#include <cmath>
#include <string>

namespace raykiln::render::io {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLargestRange = 1e30;
/// pi/2 as floats and short decimals write it.
constexpr double kWidestCone = 0.5 * kPi + 1e-6;

std::optional<LightKind> kind_of(const std::string& type) {
  if (type == "point") return LightKind::kPoint;
  if (type == "spot") return LightKind::kSpot;
  if (type == "directional") return LightKind::kDirectional;
  return std::nullopt;
}

void read_cone(const JsonAt& at, DraftLight& light) {
  light.outer_rad = 0.25 * kPi;
  const auto spot = at.object("spot");
  if (!spot) return;
  light.inner_rad = spot->number_in("innerConeAngle", 0.0, 0.0, kWidestCone);
  light.outer_rad = spot->number_in("outerConeAngle", 0.25 * kPi, 0.0, kWidestCone);
  if (!at.diagnostics().failed() && !(light.inner_rad < light.outer_rad)) {
    spot->fail(ImportErrorCode::kInvalidValue, "innerConeAngle is not below outerConeAngle");
  }
}

void read_range(const JsonAt& at, DraftLight& light) {
  if (!at.has("range")) return;
  if (light.kind == LightKind::kDirectional) {
    at.warn(ImportWarningCode::kIgnoredFeature, "directional lights have no range: it is ignored");
    return;
  }
  light.range = at.number_or("range", 0.0);
  if (!at.diagnostics().failed() && !(light.range > 0.0 && light.range <= kLargestRange)) {
    at.member("range").fail(ImportErrorCode::kInvalidValue, "a range is above 0");
  }
}

}  // namespace

// Candela are taken as W/sr one to one and lux as W/m^2, as emissive radiance is: the file's
// proportions stay. A light shines along -z of its node; scale changes neither cone nor range.
std::optional<DraftLight> read_gltf_light(const JsonAt& at, const JsonAt& node,
                                          const Mat4d& to_world) {
  const std::string type = at.text_or("type", "");
  if (at.diagnostics().failed()) return std::nullopt;
  const auto kind = kind_of(type);
  if (!kind) {
    at.warn(ImportWarningCode::kUnsupportedLight,
            "lights are point, spot or directional, this one is " + in_quotes(type));
    return std::nullopt;
  }
  DraftLight light;
  light.kind = *kind;
  light.name = clean_text(at.text_or("name", node.text_or("name", "light")));
  light.power = at.vec3_in("color", Vec3d(1.0), 0.0, 1.0) *
                at.number_in("intensity", 1.0, 0.0, at.diagnostics().limits().max_radiance);
  light.position = Vec3d(to_world[3]);
  light.direction = -Vec3d(to_world[2]);
  if (*kind == LightKind::kSpot) read_cone(at, light);
  read_range(at, light);
  if (at.diagnostics().failed()) return std::nullopt;
  const double length2 = dot(light.direction, light.direction);
  if (*kind != LightKind::kPoint && !(length2 > 0.0 && std::isfinite(length2))) {
    node.warn(ImportWarningCode::kUnsupportedLight, "a light with a flat transform is ignored");
    return std::nullopt;
  }
  return light;
}

}  // namespace raykiln::render::io
