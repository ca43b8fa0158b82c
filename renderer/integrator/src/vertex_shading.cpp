#include "vertex_shading.hpp"

namespace raykiln::render {

ShadeRange shading_loop(const Switches& switches) {
  if (switches.reduced) return shade_reduced;
  if (switches.transmission) return shade_general;
  if (switches.specular) return shade_opaque;
  if (switches.normals) return shade_matte;
  return switches.bounces ? shade_flat_matte : shade_direct_flat_matte;
}

}  // namespace raykiln::render
