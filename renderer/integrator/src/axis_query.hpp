// What passes between the tracer and the kernels for several vertices on mirrors and clear borders at once. Plain data
// and pointers only: see vertex_query.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "vertex_query.hpp"

namespace raykiln::render {

/// A material that scatters along axes alone.
struct LaneAxisMaterial {
  double opaque[3], clear[3];  ///< Bsdf::specular_opaque, specular_transparent
  double transparent, index;
};

/// Reads of one scene, and where the outcome goes. Fresnel's equations; all paths may go on.
struct AxisQuery : VertexQuery {
  const float* normals;                 ///< 3 floats each
  const std::uint32_t* corner_normals;  ///< three a triangle; null where nothing is interpolated
  const LaneAxisMaterial* materials;

  bool radiance_scaling;
  double peak;  ///< density of the lobe along its axis
  /// The random number of a dimension at the path's vertex.
  double (*number)(const LanePath& path, std::uint32_t dimension);
  std::uint32_t side_dimension, roulette_dimension;

  double emitters_lo[3], emitters_hi[3];  ///< the box of all emitters
  double axis_width;                      ///< kAxisWidth
  const double* point_lights;             ///< places, 3 doubles each
  std::size_t point_light_count;

  std::uint32_t* left;  ///< those of `chosen` that a light may lie along an axis of: not shaded
};

struct AxisCounts : VertexCounts {
  std::size_t left;
};

using AxisKernel = void (*)(const AxisQuery& query, AxisCounts& counts);

/// nullptr where this build has no such kernel.
AxisKernel axis_kernel_avx2();
AxisKernel axis_kernel_avx512();

}  // namespace raykiln::render
