// Small cells: the triangles on both sides of every plane are counted, kLanes planes at a time.
#pragma once

#include "build_kernel_lanes.hpp"

namespace raykiln::render {
namespace {

/// The planes of one axis: lower ends of extents, then upper ones, then some in the cell's face.
struct PlanesOfAxis {
  float position[2 * kCountingMax + 2 * kLanes];
  std::int32_t n_left[2 * kCountingMax + 2 * kLanes], n_right[2 * kCountingMax + 2 * kLanes];
  std::int32_t n_planar[2 * kCountingMax + 2 * kLanes];
  float least[2 * kCountingMax + 2 * kLanes];
  std::uint32_t size;
  bool planar;
};

inline void take_planes(const CountingQuery& q, std::uint32_t axis, PlanesOfAxis& to) {
  to.planar = false;
  for (std::uint32_t i = 0; i < q.n; ++i) {
    const float lo = q.references[8 * i + axis];
    const float hi = q.references[8 * i + 4 + axis];
    to.position[i] = lo;
    to.position[q.n + i] = hi;
    to.planar |= lo == hi;
  }
  to.size = (2 * q.n + 2 * kLanes - 1) / (2 * kLanes) * (2 * kLanes);
  for (std::uint32_t i = 2 * q.n; i < to.size; ++i) to.position[i] = q.cell_lo[axis];
}

inline Floats rough_cost(const CountingQuery& q, std::uint32_t axis, const Floats& p, const Ints& n_left,
                         const Ints& n_right) {
  const RoughCost& c = q.cost[axis];
  const Floats part = (p - q.cell_lo[axis]) * q.per_width[axis];
  const Floats left = (c.cap + c.side * part) * __builtin_convertvector(n_left, Floats);
  const Floats right = (c.cap + c.side * (1.0F - part)) * __builtin_convertvector(n_right, Floats);
  const Floats cost = c.step + (left + right);
  return (n_left == 0) | (n_right == 0) ? cost * c.empty_factor : cost;
}

/// Fills counts and costs; gives a cost that the cheapest plane does not exceed. Costs of planes that
/// are none, in the cell's faces, are infinite.
template <bool kPlanar>
inline float count_sides(const CountingQuery& q, std::uint32_t axis, PlanesOfAxis& planes) {
  const std::uint32_t n = q.n;
  const float* const lows = planes.position;
  const float* const highs = planes.position + n;
  Floats least = all_of(kInfinite);
  for (std::uint32_t at = 0; at < planes.size; at += 2 * kLanes) {
    const Floats p0 = lanes_at<Floats>(planes.position + at);
    const Floats p1 = lanes_at<Floats>(planes.position + at + kLanes);
    Ints left0{}, left1{}, right0{}, right1{}, both0{}, both1{};
    for (std::uint32_t i = 0; i < n; ++i) {
      const Floats lo = all_of(lows[i]);
      const Floats hi = all_of(highs[i]);
      const Ints before0 = lo < p0, before1 = lo < p1, behind0 = hi > p0, behind1 = hi > p1;
      left0 -= before0;
      left1 -= before1;
      right0 -= behind0;
      right1 -= behind1;
      if (kPlanar) {
        both0 -= before0 & behind0;
        both1 -= before1 & behind1;
      }
    }
    const auto keep = [&](std::uint32_t to, const Floats& p, const Ints& n_left, const Ints& n_right,
                          const Ints& n_both) {
      const Ints inside = (p > q.cell_lo[axis]) & (p < q.cell_hi[axis]);
      const Ints n_planar = kPlanar ? static_cast<std::int32_t>(n) - n_left - n_right + n_both : Ints{};
      Floats cost{};
      if (q.cost[axis].usable) {
        cost = rough_cost(q, axis, p, n_left + n_planar, n_right);
        if (kPlanar) {
          const Floats other = rough_cost(q, axis, p, n_left, n_right + n_planar);
          cost = other < cost ? other : cost;
        }
      }
      cost = inside ? cost : all_of(kInfinite);
      __builtin_memcpy(planes.n_planar + to, &n_planar, sizeof n_planar);
      __builtin_memcpy(planes.n_left + to, &n_left, sizeof n_left);
      __builtin_memcpy(planes.n_right + to, &n_right, sizeof n_right);
      __builtin_memcpy(planes.least + to, &cost, sizeof cost);
      cost = n_left + n_right + n_planar <= q.affordable ? cost : all_of(kInfinite);
      least = cost < least ? cost : least;
    };
    keep(at, p0, left0, right0, both0);
    keep(at + kLanes, p1, left1, right1, both1);
  }
  return q.cost[axis].usable ? lowest(least) : kInfinite;
}

inline void add_plane(CountedPlanes& result, std::uint32_t axis, float position, float least,
                      std::uint32_t n_left, std::uint32_t n_right, std::uint32_t n_planar) {
  result.planes[result.size++] = {position, least, n_left, n_right, n_planar, axis};
}

/// The only planes with an empty side are those before and behind all triangles.
inline void add_empty_cuts(const CountingQuery& q, std::uint32_t axis, float first, float last,
                           CountedPlanes& result) {
  if (q.cell_lo[axis] < first && first < q.cell_hi[axis]) {
    std::uint32_t n_right = 0;
    for (std::uint32_t i = 0; i < q.n; ++i) n_right += q.references[8 * i + 4 + axis] > first ? 1U : 0U;
    add_plane(result, axis, first, 0.0F, 0, n_right, q.n - n_right);
  }
  if (q.cell_lo[axis] < last && last < q.cell_hi[axis] && last != first) {
    std::uint32_t n_left = 0;
    for (std::uint32_t i = 0; i < q.n; ++i) n_left += q.references[8 * i + axis] < last ? 1U : 0U;
    add_plane(result, axis, last, 0.0F, n_left, 0, q.n - n_left);
  }
}

inline void add_cheap_planes(const PlanesOfAxis& planes, std::uint32_t axis, float threshold,
                             CountedPlanes& result) {
  for (std::uint32_t at = 0; at < planes.size; at += kLanes) {
    if (!any(lanes_at<Floats>(planes.least + at) <= threshold)) continue;
    for (std::uint32_t i = at; i < at + kLanes; ++i) {
      if (!(planes.least[i] <= threshold)) continue;
      add_plane(result, axis, planes.position[i], planes.least[i],
                static_cast<std::uint32_t>(planes.n_left[i]),
                static_cast<std::uint32_t>(planes.n_right[i]),
                static_cast<std::uint32_t>(planes.n_planar[i]));
    }
  }
}

// With triangles on both sides, N_left + N_right is N at least and the areas are those of the cell
// and of the plane together, so a split costs no less than step + (cap + side) + cap (N - 1). Where
// that is more than a leaf costs, only empty space can be cut off.
void count_planes(const CountingQuery& q, CountedPlanes& result) {
  PlanesOfAxis planes[3];
  bool full[3];
  float threshold = q.leaf;
  result.size = result.full_axes = 0;
  typedef float Float4 __attribute__((vector_size(16)));
  Float4 first = lanes_at<Float4>(q.references);
  Float4 last = lanes_at<Float4>(q.references + 4);
  for (std::uint32_t i = 1; i < q.n; ++i) {
    const auto lo = lanes_at<Float4>(q.references + 8 * i);
    const auto hi = lanes_at<Float4>(q.references + 8 * i + 4);
    first = lo < first ? lo : first;
    last = hi > last ? hi : last;
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const RoughCost& c = q.cost[axis];
    const float both_sides = c.step + (c.cap + c.side) + c.cap * static_cast<float>(q.n - 1);
    full[axis] = !c.usable || both_sides * (1.0F - kRoughSlack) <= q.leaf;
    if (!full[axis]) continue;
    ++result.full_axes;
    take_planes(q, axis, planes[axis]);
    const float cheapest = planes[axis].planar ? count_sides<true>(q, axis, planes[axis])
                                               : count_sides<false>(q, axis, planes[axis]);
    threshold = cheapest < threshold ? cheapest : threshold;
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    if (!full[axis]) {
      add_empty_cuts(q, axis, first[axis], last[axis], result);
      continue;
    }
    // What is cancelled in 1 - part is a share of side N, which may be more than the cost.
    const RoughCost& c = q.cost[axis];
    const float slack = 1e-6F * (c.cap + c.side) * static_cast<float>(q.n);
    const float wanted = threshold * (1.0F + kRoughSlack) + slack;
    add_cheap_planes(planes[axis], axis, c.usable && wanted < kLargest ? wanted : kLargest, result);
  }
}

}  // namespace
}  // namespace raykiln::render
