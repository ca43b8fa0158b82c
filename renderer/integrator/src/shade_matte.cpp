#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_matte(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  shade_range<kMatte>(transport, range, sinks);
}

}  // namespace raykiln::render
