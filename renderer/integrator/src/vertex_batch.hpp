// How the kernels for several vertices at once get at the paths of a step, and how what they write gets back.
#pragma once

#include <cstdint>
#include <vector>

#include "transport.hpp"
#include "vertex_query.hpp"
#include "vertex_shading.hpp"

namespace raykiln::render {

/// What does not change from call to call. `transport` outlives the query.
void read_scene(VertexQuery& query, const Transport& transport);

/// Points `query` at the chosen vertices of `range`, counted from its beginning, and makes room in `sinks` for as many paths.
void open_batch(VertexQuery& query, const std::vector<std::uint32_t>& chosen, const Transport& transport,
                const ShadingRange& range, ShadingSinks& sinks);

/// Keeps what was written of that room, and empties `chosen`.
void close_batch(const VertexCounts& counts, std::vector<std::uint32_t>& chosen, const Transport& transport,
                 ShadingSinks& sinks);

}  // namespace raykiln::render
