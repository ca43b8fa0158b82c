// What passes between the tracer and the kernels that shoot several camera rays at once. Plain data and pointers
// only: see vertex_query.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_path.hpp"

namespace raykiln::render {

/// PathStart, as it lies in memory.
struct LaneStart {
  std::int32_t x, y;
  std::uint64_t sample;
};

/// Rays of a pinhole in perspective, through the pixels themselves.
struct CameraQuery {
  std::uint64_t seed_word;  ///< what path_key() makes of the seed
  bool sobol;
  const std::uint32_t* sobol_third;  ///< sobol::kThird, 16 words for each four digits of an index
  bool in_pixel;  ///< somewhere in the pixel, not in its middle
  std::int32_t window_x, window_y;
  double eye[3], corner[3], step_x[3], step_y[3], lo[3], hi[3];  ///< CameraRays::Pinhole

  const LaneStart* starts;
  std::size_t count;
  std::uint32_t first_slot;
  LaneRay* rays;  ///< one a start, and so for what goes with it
  LanePath* paths;
};

using CameraKernel = void (*)(const CameraQuery& query);

/// nullptr where this build has no such kernel.
CameraKernel camera_kernel_avx2();
CameraKernel camera_kernel_avx512();

}  // namespace raykiln::render
