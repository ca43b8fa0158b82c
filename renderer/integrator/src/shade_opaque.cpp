#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_opaque(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  shade_range<kOpaque>(transport, range, sinks);
}

}  // namespace raykiln::render
