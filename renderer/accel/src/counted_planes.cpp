#include <algorithm>
#include <bit>

#include "plane_search.hpp"

namespace raykiln::render {
namespace {

using Lanes = std::array<float, kCountingMax + 4>;

// Costs of planes across one axis in float, to pass over those that cannot be the cheapest.
struct RoughCost {
  Float4 lo, per_width, cap, side, k_t, k_i, empty_factor;
  bool usable = false;

  RoughCost(const Bounds3f& cell, int axis, const BuildParams& params) {
    const auto extent = [&](int k) {
      return static_cast<double>(cell.hi[k]) - static_cast<double>(cell.lo[k]);
    };
    const double y = extent((axis + 1) % 3);
    const double z = extent((axis + 2) % 3);
    const double half_area = y * z + extent(axis) * (y + z);
    const auto width = static_cast<float>(extent(axis));
    const auto all = [](double x) {
      const auto f = static_cast<float>(x);
      return Float4{f, f, f, f};
    };
    lo = all(static_cast<double>(cell.lo[axis]));
    per_width = all(1.0 / static_cast<double>(width));
    cap = all(y * z / half_area);
    side = all(extent(axis) * (y + z) / half_area);
    k_t = all(params.k_t);
    k_i = all(params.k_i);
    empty_factor = all(params.empty_factor);
    usable = width > 1e-30F && width < 1e30F && half_area > 0.0 && params.k_t < 1e30 &&
             params.k_i > 1e-30 && params.k_i < 1e30;
  }

  /// Planes that may cost `threshold` or less; triangles in the plane are on no side.
  [[nodiscard]] Int4 may_reach(Float4 p, Int4 n_left, Int4 n_right, float threshold) const {
    const Float4 part = (p - lo) * per_width;
    const Float4 left = (cap + side * part) * __builtin_convertvector(n_left, Float4);
    const Float4 right = (cap + side * (1.0F - part)) * __builtin_convertvector(n_right, Float4);
    Float4 cost = k_t + k_i * (left + right);
    cost = (n_left == 0) | (n_right == 0) ? cost * empty_factor : cost;
    return cost <= Float4{threshold, threshold, threshold, threshold};
  }
};

// One axis of a cell's references.
struct AxisExtents {
  Lanes lo, hi;
  std::size_t n = 0;
  float cell_lo = 0.0F, cell_hi = 0.0F;
  bool has_planar = false;
};

std::uint32_t planars_at(const AxisExtents& axis, float p) {
  std::uint32_t planars = 0;
  for (std::size_t i = 0; i < axis.n; ++i) {
    planars += axis.lo[i] >= p && axis.hi[i] <= p ? 1U : 0U;
  }
  return planars;
}

// Counts the sides of four planes at once and offers those that may cost `threshold` or less.
void consider_four(const AxisExtents& axis, const float* positions, const RoughCost& rough,
                   float threshold, PlaneChooser& chooser) {
  Float4 p;
  std::memcpy(&p, positions, sizeof p);
  Int4 n_left{0, 0, 0, 0};
  Int4 n_right{0, 0, 0, 0};
  for (std::size_t i = 0; i < axis.n; ++i) {
    const float lo = axis.lo[i];
    const float hi = axis.hi[i];
    n_left -= Float4{lo, lo, lo, lo} < p;
    n_right -= Float4{hi, hi, hi, hi} > p;
  }
  Int4 offered = (p > axis.cell_lo) & (p < axis.cell_hi);
  if (rough.usable) offered &= rough.may_reach(p, n_left, n_right, threshold);
  using Pair = std::array<std::int64_t, 2>;
  const Pair any = std::bit_cast<Pair>(offered);
  if ((any[0] | any[1]) == 0) return;
  for (std::size_t lane = 0; lane < 4; ++lane) {
    if (offered[lane] == 0) continue;
    const float position = positions[lane];
    const auto left = static_cast<std::uint32_t>(n_left[lane]);
    const auto right = static_cast<std::uint32_t>(n_right[lane]);
    const std::uint32_t planars = axis.has_planar ? planars_at(axis, position) : 0;
    chooser.consider(position, left + planars, right, true);
    if (planars > 0) chooser.consider(position, left, right + planars, false);
  }
}

void take_axis(std::span<const Reference> references, std::size_t a, const Bounds3f& cell,
               AxisExtents& axis) {
  axis.n = references.size();
  axis.cell_lo = cell.lo[static_cast<int>(a)];
  axis.cell_hi = cell.hi[static_cast<int>(a)];
  axis.has_planar = false;
  for (std::size_t i = 0; i < axis.n; ++i) {
    axis.lo[i] = references[i].lo[a];
    axis.hi[i] = references[i].hi[a];
    axis.has_planar |= axis.lo[i] == axis.hi[i];
  }
  for (std::size_t i = axis.n; i < axis.n + 4; ++i) axis.lo[i] = axis.hi[i] = axis.cell_lo;
}

// A plane with triangles on both sides costs at least a step and one test, as the areas of the
// parts add up to more than the whole. When that is no gain, only planes that cut off empty space
// can be one: those before and behind all triangles.
void consider_empty_cuts(std::span<const Reference> references, const SweepInput& input,
                         const BuildParams& params, std::span<PlaneChooser, 3> choosers) {
  Float4 first = load3(references[0].lo);
  Float4 last = load3(references[0].hi);
  for (const Reference& r : references.subspan(1)) {
    const Float4 lo = load3(r.lo);
    const Float4 hi = load3(r.hi);
    first = lo < first ? lo : first;
    last = hi > last ? hi : last;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const float cell_lo = input.cell.lo[static_cast<int>(a)];
    const float cell_hi = input.cell.hi[static_cast<int>(a)];
    if (!(cell_lo < first[a] || last[a] < cell_hi)) continue;
    AxisExtents axis;
    take_axis(references, a, input.cell, axis);
    RoughCost rough(input.cell, static_cast<int>(a), params);
    rough.usable = false;
    const std::array<float, 4> positions{first[a], last[a], cell_lo, cell_lo};
    consider_four(axis, positions.data(), rough, 0.0F, choosers[a]);
  }
}

}  // namespace

void consider_by_counting(std::span<const Reference> references, const SweepInput& input,
                          double leaf_cost, const BuildParams& params,
                          std::span<PlaneChooser, 3> choosers, BuildStats& counts) {
  const std::size_t n = references.size();
  counts.events_swept += 6 * n;
  if (leaf_cost <= (params.k_t + params.k_i) * (1.0 - 1e-9)) {
    consider_empty_cuts(references, input, params, choosers);
    return;
  }
  counts.keys_sorted_passes += 3 * n * n;  // 2n planes by n triangles, two compares, four at once
  AxisExtents axis;
  double least = leaf_cost;
  for (std::size_t a = 0; a < 3; ++a) {
    take_axis(references, a, input.cell, axis);
    const RoughCost rough(input.cell, static_cast<int>(a), params);
    for (const Lanes* ends : {&axis.lo, &axis.hi}) {
      for (std::size_t i = 0; i < n; i += 4) {
        const auto threshold = static_cast<float>(least * (1.0 + 1e-5));
        consider_four(axis, ends->data() + i, rough, threshold, choosers[a]);
        least = std::min(least, choosers[a].result().best.cost);
      }
    }
  }
}

}  // namespace raykiln::render
