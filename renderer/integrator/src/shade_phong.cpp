#include "vertex_shader.hpp"

namespace raykiln::render {

void shade_phong(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  shade_range<kPhong>(transport, range, sinks);
}

}  // namespace raykiln::render
