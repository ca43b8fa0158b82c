#include <algorithm>
#include <optional>

#include "plane_search.hpp"

namespace raykiln::render {
namespace {

CountingQuery query_of(std::span<const Reference> references, const SweepInput& input,
                       double leaf_cost, const BuildParams& params) {
  CountingQuery query{};
  query.references = words_of(references.data());
  query.n = input.n;
  query.affordable = static_cast<std::int32_t>(input.n + std::min<std::uint64_t>(input.budget, input.n));
  query.leaf = static_cast<float>(leaf_cost);
  const std::array<RoughCost, 3> costs = rough_costs(input.cell, params);
  for (int axis = 0; axis < 3; ++axis) {
    const float width = input.cell.hi[axis] - input.cell.lo[axis];
    query.cell_lo[axis] = input.cell.lo[axis];
    query.cell_hi[axis] = input.cell.hi[axis];
    query.per_width[axis] = 1.0F / width;
    query.cost[axis] = costs[static_cast<std::size_t>(axis)];
    query.cost[axis].usable &= width > 1e-30F && width < 1e30F;
  }
  return query;
}

}  // namespace

SweepResult search_by_counting(const BuildContext& context, std::span<const Reference> references,
                               const SweepInput& input, double leaf_cost, BuildStats& counts) {
  const std::uint64_t n = references.size();
  std::array<CountedPlane, kMostCountedPlanes> planes;
  CountedPlanes found{planes.data(), 0, 0};
  const CountingQuery query = query_of(references, input, leaf_cost, context.params);
  context.kernels.count_planes(query, found);
  counts.events_swept += 6 * n;
  counts.keys_sorted_passes += found.operations;
  BestOfAxes best;
  std::optional<PlaneChooser> chooser;  // planes come axis by axis
  std::uint32_t axis = 3;
  double least = leaf_cost;
  for (const CountedPlane& plane : std::span(planes).first(found.size)) {
    const RoughCost& rough = query.cost[plane.axis];
    const float slack = 1e-6F * (rough.cap + rough.side) * static_cast<float>(n);
    if (plane.least * (1.0F - 1e-5F) - slack > static_cast<float>(least)) continue;
    if (plane.axis != axis) {
      if (chooser) best.take(chooser->result());
      axis = plane.axis;
      chooser.emplace(static_cast<int>(axis), input, context.params);
    }
    chooser->consider(plane.position, plane.n_left + plane.n_planar, plane.n_right, true);
    if (plane.n_planar > 0) {
      chooser->consider(plane.position, plane.n_left, plane.n_right + plane.n_planar, false);
    }
    least = std::min(least, chooser->result().best.cost);
  }
  if (chooser) best.take(chooser->result());
  return best.result;
}

}  // namespace raykiln::render
