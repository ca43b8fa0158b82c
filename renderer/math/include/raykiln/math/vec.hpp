// Vector, matrix and colour aliases. GLM is included here and nowhere else.
#pragma once

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace raykiln::render {

using Vec2f = glm::vec2;
using Vec3f = glm::vec3;
using Vec3d = glm::dvec3;
using Vec4d = glm::dvec4;
using Mat4d = glm::dmat4;  ///< column major, m[column][row]

/// Linear scene-referred RGB: radiance (W sr^-1 m^-2), intensity (W sr^-1) or a weight.
using Rgb = glm::vec3;
using Rgbd = glm::dvec3;

using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;

/// Rec. 709 luminance of a linear RGB triple.
[[nodiscard]] inline double luminance(const Rgbd& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

}  // namespace raykiln::render
