#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_reduced(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  shade_range<kReduced>(transport, range, sinks);
}

}  // namespace raykiln::render
