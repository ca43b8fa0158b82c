#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_flat_matte(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  shade_range<kFlatMatte>(transport, range, sinks);
}

}  // namespace raykiln::render
