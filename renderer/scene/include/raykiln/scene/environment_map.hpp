// Light from all directions, as a picture.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

/// Equirectangular. Row 0 is at the zenith, +y. The middle of a row looks along -z, its right-hand
/// neighbours towards +x. Radiance is constant within a texel.
struct EnvironmentMap {
  std::string name;  ///< of the file
  int width = 0, height = 0;
  std::vector<float> rgb;     ///< radiance, W sr^-1 m^-2, three a texel; finite, >= 0
  double rotation_rad = 0.0;  ///< of the map about +y, counter-clockwise seen from above

  [[nodiscard]] Rgb texel(std::size_t index) const {
    return {rgb[3 * index], rgb[3 * index + 1], rgb[3 * index + 2]};
  }
};

}  // namespace raykiln::render
