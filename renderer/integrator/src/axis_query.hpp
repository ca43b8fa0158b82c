// What passes between the tracer and the kernels for several vertices on mirrors and clear borders at once. Plain data
// and pointers only: see matte_query.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_path.hpp"

namespace raykiln::render {

/// A material that scatters along axes alone.
struct LaneAxisMaterial {
  double opaque[3], clear[3];  ///< Bsdf::specular_opaque, specular_transparent
  double transparent, index;
};

/// Reads of one scene, and where the outcome goes. Fresnel's equations, one ray goes on from each vertex, and all of
/// them may go on.
struct AxisQuery {
  LaneMesh mesh;
  const float* normals;                 ///< 3 floats each
  const std::uint32_t* corner_normals;  ///< three a triangle; null where nothing is interpolated
  const std::uint32_t* material_ids;
  const LaneAxisMaterial* materials;

  bool radiance_scaling, roulette;
  std::uint32_t bounces_before_roulette;
  double roulette_factor;
  double peak;  ///< density of the lobe along its axis
  /// The random number of a dimension at the path's vertex.
  double (*number)(const LanePath& path, std::uint32_t dimension);
  std::uint32_t side_dimension, roulette_dimension;

  bool emitter_sampling;
  double emitters_lo[3], emitters_hi[3];  ///< the box of all emitters
  double axis_width;                      ///< kAxisWidth
  const double* point_lights;             ///< places, 3 doubles each
  std::size_t point_light_count;

  const LaneRay* rays;
  const LaneHit* hits;
  const LanePath* paths;
  const std::uint32_t* chosen;  ///< which of them are vertices of this kind
  std::size_t chosen_count;

  LaneRay* next_rays;  ///< room for one a vertex, and so for what goes with it
  LanePath* next_paths;
  std::uint32_t* next_from;    ///< the triangles that they leave
  LaneReceiver* next_origins;  ///< null where emitters are not drawn from a tree
  std::uint32_t* left;         ///< those of `chosen` that a light may lie along an axis of: not shaded
  double* emitted;             ///< of slot 0; poisoned by throughputs that are not finite
  std::size_t emitted_stride;
};

struct AxisCounts {
  std::size_t next, left;
  std::uint64_t roulette_ends;
};

using AxisKernel = void (*)(const AxisQuery& query, AxisCounts& counts);

/// nullptr where this build has no such kernel.
AxisKernel axis_kernel_avx2();
AxisKernel axis_kernel_avx512();

}  // namespace raykiln::render
