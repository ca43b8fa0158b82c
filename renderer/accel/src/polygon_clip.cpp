#include "polygon_clip.hpp"

#include "build_kernels.hpp"

namespace raykiln::render {

std::optional<Bounds3f> clipped_bounds(const std::array<Vec3f, 3>& corners, const Bounds3f& cell) {
  std::array<float, 9> words;
  float box[2][4]{};
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) words[3 * i + static_cast<std::size_t>(k)] = corners[i][k];
    box[0][k] = cell.lo[k];
    box[1][k] = cell.hi[k];
  }
  std::array<float, 8> found;
  if (!kAnyBuildKernels.clip_triangle(words.data(), box, found.data())) return std::nullopt;
  Bounds3f bounds;
  for (int k = 0; k < 3; ++k) {
    bounds.lo[k] = found[static_cast<std::size_t>(k)];
    bounds.hi[k] = found[static_cast<std::size_t>(k) + 4];
  }
  return bounds;
}

}  // namespace raykiln::render
