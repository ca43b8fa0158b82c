#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_general(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  shade_range<kGeneral>(transport, range, sinks);
}

}  // namespace raykiln::render
