#include "vertex_batch.hpp"

#include <cstddef>

namespace raykiln::render {
namespace {

static_assert(sizeof(LaneHit) == sizeof(Hit) && offsetof(LaneHit, id) == offsetof(Hit, id) &&
              offsetof(LaneHit, u) == offsetof(Hit, u));
static_assert(sizeof(LaneReceiver) == sizeof(EmitterReceiver) &&
              offsetof(LaneReceiver, both_sides) == offsetof(EmitterReceiver, both_sides));
static_assert(offsetof(PathResult, emitted) == 0 && sizeof(PathResult) % sizeof(double) == 0);

}  // namespace

void read_scene(VertexQuery& query, const Transport& transport) {
  const TriangleMesh& mesh = transport.mesh;
  query.mesh = {&mesh.positions.data()->x, mesh.triangles.data()->data()};
  query.material_ids = mesh.material_ids.data();
  query.emitter_sampling = transport.settings.emitter_sampling;
  query.roulette = transport.settings.bsdf.light.roulette;
  query.bounces_before_roulette = static_cast<std::uint32_t>(kFirstDrawAfter);
  query.roulette_factor = kRouletteFactor;
  query.emitted_stride = sizeof(PathResult) / sizeof(double);
}

void open_batch(VertexQuery& query, const std::vector<std::uint32_t>& chosen, const Transport& transport,
                const ShadingRange& range, ShadingSinks& sinks) {
  query.rays = reinterpret_cast<const LaneRay*>(range.front.rays().data() + range.begin);
  query.hits = reinterpret_cast<const LaneHit*>(range.hits.data());
  query.paths = reinterpret_cast<const LanePath*>(range.front.states().data() + range.begin);
  query.chosen = chosen.data();
  query.chosen_count = chosen.size();
  PathStream& next = sinks.next;
  const std::size_t before = next.size();
  next.resize(before + chosen.size(), transport.emitters_by_tree);
  query.next_rays = reinterpret_cast<LaneRay*>(next.rays().data() + before);
  query.next_paths = reinterpret_cast<LanePath*>(next.states().data() + before);
  query.next_from = next.from().data() + before;
  query.next_origins =
      transport.emitters_by_tree ? reinterpret_cast<LaneReceiver*>(next.origins.data() + before) : nullptr;
  query.emitted = &sinks.results.data()->emitted.x;
}

void close_batch(const VertexCounts& counts, std::vector<std::uint32_t>& chosen, const Transport& transport,
                 ShadingSinks& sinks) {
  sinks.next.resize(sinks.next.size() - chosen.size() + counts.next, transport.emitters_by_tree);
  sinks.stats.roulette_ends += counts.roulette_ends;
  chosen.clear();
}

}  // namespace raykiln::render
