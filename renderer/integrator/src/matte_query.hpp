// What passes between the shading of one vertex at a time and the kernels that shade several at once, each
// of which is compiled for one instruction set. Plain data and pointers only: see vertex_query.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "vertex_query.hpp"

namespace raykiln::render {

/// The light of a shadow ray and whose it is.
struct LaneLight {
  double light[3];
  std::uint32_t slot;
};

struct LanePointLight {
  double position[3], intensity[3];
  double range2;  ///< square of the range; 0: endless
};

/// EmitterTree::Draw, of density 0 where nothing can be drawn.
struct LaneDraw {
  std::uint32_t triangle;
  double pdf_area;
};

constexpr std::size_t kLaneMostCasters = 8;

/// Bodies towards which directions are drawn, too, and the constants of caster_cones.hpp.
struct LaneCasters {
  const double* spheres;  ///< centre and radius
  std::size_t count;
  double boost, most, least_cone;
  std::uint32_t last_bounce;
};

/// Reads of one scene, and where the outcome goes. Vertices lie on flat triangles of diffuse, opaque materials
/// that do not shine; directions are sampled by the cosine, and all paths may go on.
struct MatteQuery : VertexQuery {
  const float* diffuse;   ///< of each material, 3 floats
  const float* emission;  ///< of each material, 3 floats

  bool sobol;
  const std::uint32_t* sobol_third;  ///< sobol::kThird, 16 words for each four digits of an index

  const std::uint32_t* emitters;  ///< triangles
  const double* cumulative;       ///< of their weights
  std::size_t emitter_count;
  const double* pdf_area;  ///< one a material
  LaneDraw (*draw)(const void* tree, const LaneReceiver& receiver, double u);
  const void* tree;  ///< null where emitters are drawn by power

  const LanePointLight* point_lights;
  std::size_t point_light_count;

  LaneCasters casters;

  LaneRay* shadow_rays;  ///< room for one a vertex and light, and one more a vertex
  LaneLight* shadow_lights;
  std::uint32_t* shadow_from;  ///< the triangles on which they begin
  std::uint32_t* shadow_to;    ///< those on which they end; kNoHit stands there
};

struct MatteCounts : VertexCounts {
  std::size_t shadows;
  std::uint64_t lights_at_hits;
};

using MatteKernel = void (*)(const MatteQuery& query, MatteCounts& counts);

/// nullptr where this build has no such kernel.
MatteKernel matte_kernel_avx2();
MatteKernel matte_kernel_avx512();

}  // namespace raykiln::render
