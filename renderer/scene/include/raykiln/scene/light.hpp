// Lights without a surface: found by shadow rays alone, never by a path.
#pragma once

#include <limits>
#include <string>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

/// Beyond it a light at a place shines on nothing; infinite for light that only distance weakens.
inline constexpr float kEndlessRange = std::numeric_limits<float>::infinity();

struct PointLight {
  std::string name;
  Vec3f position{0.0F};  ///< relative to Scene::origin
  Rgb intensity{0.0F};   ///< W sr^-1
  float range = kEndlessRange;  ///< metres
};

/// A point light that shines into a cone: all of `intensity` up to the inner angle from the axis,
/// nothing from the outer one on. Angles are kept as 1 - cos, which stays exact for narrow cones.
struct SpotLight {
  std::string name;
  Vec3f position{0.0F};  ///< relative to Scene::origin
  Rgb intensity{0.0F};   ///< W sr^-1, along the axis
  float range = kEndlessRange;  ///< metres
  Vec3d axis{0.0, 0.0, -1.0};   ///< unit; the way in which it shines
  double inner_one_minus_cos = 0.0;
  double outer_one_minus_cos = 1.0;  ///< >= inner_one_minus_cos
};

/// Parallel light from outside of the scene.
struct DirectionalLight {
  std::string name;
  Vec3d direction{0.0, -1.0, 0.0};  ///< unit; the way in which it shines
  Rgb irradiance{0.0F};             ///< W m^-2, of a surface that faces it
};

}  // namespace raykiln::render
