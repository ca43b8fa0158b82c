#include "vertex_shading.hpp"

namespace raykiln::render {

ShadingLoop shading_loop(const Switches& switches) {
  if (switches.reduced) return {"reduced", shade_reduced};
  if (switches.rich) return {"general", shade_general};
  if (switches.transmission) return {"phong", shade_phong};
  if (switches.specular) return {"opaque", shade_opaque};
  if (switches.normals) return {"matte", shade_matte};
  if (switches.bounces) return {"flat_matte", shade_flat_matte};
  return {"direct_flat_matte", shade_direct_flat_matte};
}

}  // namespace raykiln::render
