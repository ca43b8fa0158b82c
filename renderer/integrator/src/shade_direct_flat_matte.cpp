#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_direct_flat_matte(const Transport& transport, const ShadingRange& range,
                             ShadingSinks& sinks) {
  shade_range<kDirectFlatMatte>(transport, range, sinks);
}

}  // namespace raykiln::render
