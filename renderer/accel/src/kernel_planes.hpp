// The triangles on both sides of planes are counted, kLanes planes at a time: of small cells, where a
// few marks across each axis tell first which planes may be cheap, and of single bins of larger ones.
#pragma once

#include "build_kernel_lanes.hpp"

namespace raykiln::render {
namespace {

/// The ends of extents within a stretch of an axis, and how many triangles lie before and behind it.
struct Stretch {
  const float *lows, *highs, *planars;
  std::uint32_t n_lows, n_highs, n_planars;
  std::int32_t n_left, n_right;
  float after, before;  ///< planes lie strictly between
};

/// What all planes across an axis share.
struct AxisOfCell {
  std::uint32_t axis;
  std::int32_t n, affordable;
  float lo, per_width;
  RoughCost cost;
};

/// All ends of a stretch and what was counted for planes there; some more in the end are none.
struct PlanesOfAxis {
  float position[2 * kCountingMax + 2 * kLanes];
  std::int32_t n_left[2 * kCountingMax + 2 * kLanes], n_right[2 * kCountingMax + 2 * kLanes];
  std::int32_t n_planar[2 * kCountingMax + 2 * kLanes];
  float least[2 * kCountingMax + 2 * kLanes];
  std::uint32_t size;
};

template <typename Real, typename Count>
inline Real rough_cost(const AxisOfCell& a, const Real& p, const Count& n_left, const Count& n_right) {
  const RoughCost& c = a.cost;
  const Real part = (p - a.lo) * a.per_width;
  return c.step + ((c.cap + c.side * part) * n_left + (c.cap + c.side * (1.0F - part)) * n_right);
}

inline Floats rough_cost_of(const AxisOfCell& a, const Floats& p, const Ints& n_left, const Ints& n_right) {
  const Floats cost = rough_cost(a, p, __builtin_convertvector(n_left, Floats), __builtin_convertvector(n_right, Floats));
  return (n_left == 0) | (n_right == 0) ? cost * a.cost.empty_factor : cost;
}

/// What the cheapest plane costs at most, among those within the budget and those beyond it.
struct Cheapest {
  float within, beyond;
};

/// Fills counts and costs. Costs of planes that are none are infinite.
template <bool kPlanar>
inline Cheapest count_sides(const AxisOfCell& a, const Stretch& s, PlanesOfAxis& planes) {
  __builtin_memcpy(planes.position, s.lows, s.n_lows * sizeof(float));
  __builtin_memcpy(planes.position + s.n_lows, s.highs, s.n_highs * sizeof(float));
  const std::uint32_t n = s.n_lows + s.n_highs;
  planes.size = (n + 2 * kLanes - 1) / (2 * kLanes) * (2 * kLanes);
  for (std::uint32_t i = n; i < planes.size; ++i) planes.position[i] = s.after;
  Floats within = all_of(kInfinite), beyond = within;
  for (std::uint32_t at = 0; at < planes.size; at += 2 * kLanes) {
    const Floats p0 = lanes_at<Floats>(planes.position + at);
    const Floats p1 = lanes_at<Floats>(planes.position + at + kLanes);
    Ints left0 = all_of(s.n_left), left1 = left0, right0 = all_of(s.n_right), right1 = right0;
    Ints planar0{}, planar1{};
    for (std::uint32_t i = 0; i < s.n_lows; ++i) {  // true is -1
      const Floats lo = all_of(s.lows[i]);
      left0 -= lo < p0;
      left1 -= lo < p1;
    }
    for (std::uint32_t i = 0; i < s.n_highs; ++i) {
      const Floats hi = all_of(s.highs[i]);
      right0 -= hi > p0;
      right1 -= hi > p1;
    }
    for (std::uint32_t i = 0; kPlanar && i < s.n_planars; ++i) {
      const Floats x = all_of(s.planars[i]);
      planar0 -= x == p0;
      planar1 -= x == p1;
    }
    const auto keep = [&](std::uint32_t to, const Floats& p, const Ints& n_left, const Ints& n_right,
                          const Ints& n_planar) {
      const Ints inside = (p > s.after) & (p < s.before);
      Floats cost{};
      if (a.cost.usable) {
        cost = rough_cost_of(a, p, n_left + n_planar, n_right);
        if (kPlanar) {
          const Floats other = rough_cost_of(a, p, n_left, n_right + n_planar);
          cost = other < cost ? other : cost;
        }
      }
      cost = inside ? cost : all_of(kInfinite);
      __builtin_memcpy(planes.n_planar + to, &n_planar, sizeof n_planar);
      __builtin_memcpy(planes.n_left + to, &n_left, sizeof n_left);
      __builtin_memcpy(planes.n_right + to, &n_right, sizeof n_right);
      __builtin_memcpy(planes.least + to, &cost, sizeof cost);
      const Ints is_within = n_left + n_right + n_planar <= a.affordable;
      within = is_within & (cost < within) ? cost : within;
      beyond = ~is_within & (cost < beyond) ? cost : beyond;
    };
    keep(at, p0, left0, right0, planar0);
    keep(at + kLanes, p1, left1, right1, planar1);
  }
  if (!a.cost.usable) return {kInfinite, kInfinite};
  return {lowest(within), lowest(beyond)};
}

inline void add_plane(CountedPlanes& result, std::uint32_t axis, float position, float least,
                      std::uint32_t n_left, std::uint32_t n_right, std::uint32_t n_planar) {
  result.planes[result.size++] = {position, least, n_left, n_right, n_planar, axis};
}

inline void add_cheap_planes(const AxisOfCell& a, const PlanesOfAxis& planes, float wanted,
                             float wanted_beyond, CountedPlanes& result) {
  for (std::uint32_t at = 0; at < planes.size; at += kLanes) {
    if (!any(lanes_at<Floats>(planes.least + at) <= wanted)) continue;
    for (std::uint32_t i = at; i < at + kLanes; ++i) {
      const bool within = planes.n_left[i] + planes.n_right[i] + planes.n_planar[i] <= a.affordable;
      if (!(planes.least[i] <= (within ? wanted : wanted_beyond))) continue;
      add_plane(result, a.axis, planes.position[i], planes.least[i],
                static_cast<std::uint32_t>(planes.n_left[i]),
                static_cast<std::uint32_t>(planes.n_right[i]),
                static_cast<std::uint32_t>(planes.n_planar[i]));
    }
  }
}

/// What planes may cost at most when a cost is at hand: all that floats may have lost is added. What
/// is cancelled in 1 - part is a share of side N, which may be more than the cost.
inline float wanted_of(const AxisOfCell& a, float threshold) {
  const float slack = 2e-6F * (a.cost.cap + a.cost.side) * static_cast<float>(a.n);
  const float wanted = threshold * (1.0F + 2.0F * kRoughSlack) + slack;
  return a.cost.usable && wanted < kLargest ? wanted : kLargest;
}

/// Adds the planes of a stretch that may be the cheapest, of those beyond the budget only these; gives
/// what the cheapest within it costs at most, or the threshold.
inline float add_planes(const AxisOfCell& a, const Stretch& s, float threshold, float beyond,
                        CountedPlanes& result) {
  PlanesOfAxis planes;
  const Cheapest cheapest = s.n_planars > 0 ? count_sides<true>(a, s, planes) : count_sides<false>(a, s, planes);
  threshold = cheapest.within < threshold ? cheapest.within : threshold;
  beyond = cheapest.beyond < beyond ? cheapest.beyond : beyond;
  beyond = threshold < beyond ? threshold : beyond;
  add_cheap_planes(a, planes, wanted_of(a, threshold), wanted_of(a, beyond), result);
  return threshold;
}

/// Comparisons, four as one.
inline std::uint64_t operations_of(const Stretch& s) {
  const std::uint64_t n = s.n_lows + s.n_highs;
  return n * n / 4;
}

/// Where the triangles of a small cell begin and end.
struct Extremes {
  Float4 first, last;
  Int4 planar;  ///< axes with a triangle that is planar there

  inline explicit Extremes(const CountingQuery& q) {
    first = lanes_at<Float4>(q.references);
    last = lanes_at<Float4>(q.references + 4);
    planar = first == last;
    for (std::uint32_t i = 1; i < q.n; ++i) {
      const auto lo = lanes_at<Float4>(q.references + 8 * i);
      const auto hi = lanes_at<Float4>(q.references + 8 * i + 4);
      first = lo < first ? lo : first;
      last = hi > last ? hi : last;
      planar |= lo == hi;
    }
  }
};

/// The planes before and behind all triangles, the only ones with an empty side.
struct EmptyCuts {
  std::int32_t planar_first = 0, planar_last = 0;  ///< how many triangles lie in them
  float least_first = kInfinite, least_last = kInfinite;

  inline EmptyCuts() = default;
  inline EmptyCuts(const CountingQuery& q, const AxisOfCell& a, const Extremes& e) {
    const float first = e.first[a.axis], last = e.last[a.axis];
    if (e.planar[a.axis] != 0) {
      for (std::uint32_t i = 0; i < q.n; ++i) {
        planar_first += q.references[8 * i + 4 + a.axis] == first ? 1 : 0;
        planar_last += q.references[8 * i + a.axis] == last ? 1 : 0;
      }
    }
    if (q.cell_lo[a.axis] < first && first < q.cell_hi[a.axis]) {
      least_first = least(a, first, a.n - planar_first, planar_first, false);
    }
    if (q.cell_lo[a.axis] < last && last < q.cell_hi[a.axis] && last != first) {
      least_last = least(a, last, a.n - planar_last, planar_last, true);
    }
  }

 private:
  static inline float least(const AxisOfCell& a, float p, std::int32_t n, std::int32_t n_planar, bool left) {
    const auto all = static_cast<float>(a.n);
    const float cut = a.cost.empty_factor * rough_cost(a, p, left ? all : 0.0F, left ? 0.0F : all);
    if (n_planar == 0) return cut;
    const auto most = static_cast<float>(n), flat = static_cast<float>(n_planar);
    float apart = rough_cost(a, p, left ? most : flat, left ? flat : most);
    apart = n == 0 ? a.cost.empty_factor * apart : apart;
    return apart < cut ? apart : cut;
  }
};

/// A few marks across an axis: between two of them lie planes of which something is known.
template <std::uint32_t kMarks>
struct Marks {
  static constexpr int kMarkVectors = kMarks / kLanes;
  float at[kMarks + 1];
  float least[kMarks];  ///< no plane between a mark and the next costs less

  // Triangles that begin before a mark lie left of all planes behind it. Those that are neither left
  // nor right for certain are on one side at least, and areas are linear between two marks.
  inline Marks(const CountingQuery& q, const AxisOfCell& a, const Extremes& e) {
    const float first = e.first[a.axis], last = e.last[a.axis];
    for (std::uint32_t i = 0; i < kMarks; ++i) {
      at[i] = first + (last - first) * (static_cast<float>(i) / static_cast<float>(kMarks));
    }
    at[kMarks] = last;
    Floats from[kMarkVectors], to[kMarkVectors];
    Ints n_left[kMarkVectors], n_right[kMarkVectors];
    for (int v = 0; v < kMarkVectors; ++v) {
      from[v] = lanes_at<Floats>(at + v * kLanes);
      to[v] = lanes_at<Floats>(at + v * kLanes + 1);
      n_left[v] = n_right[v] = Ints{};
    }
    const float* reference = q.references + a.axis;
    for (std::uint32_t i = 0; i < q.n; ++i, reference += 8) {
      const Floats lo = all_of(reference[0]);
      const Floats hi = all_of(reference[4]);
      for (int v = 0; v < kMarkVectors; ++v) {
        n_left[v] -= lo < from[v];
        n_right[v] -= hi > to[v];
      }
    }
    const auto n = all_of(static_cast<float>(q.n));
    for (int v = 0; v < kMarkVectors; ++v) {
      const Floats nl = __builtin_convertvector(n_left[v], Floats);
      const Floats nr = __builtin_convertvector(n_right[v], Floats);
      const Floats known = nl + nr, most = known > n ? known : n;
      const auto sides_at = [&](const Floats& mark) {
        const Floats x = (mark - a.lo) * a.per_width, rest = 1.0F - x;
        return x * nl + rest * nr + (x < rest ? x : rest) * (most - known);
      };
      const Floats one = sides_at(from[v]), other = sides_at(to[v]);
      const Floats cost = a.cost.step + (a.cost.cap * most + a.cost.side * (one < other ? one : other));
      __builtin_memcpy(least + v * kLanes, &cost, sizeof cost);
    }
  }
};

/// The ends of a cell's extents from one mark to another.
struct Ends {
  float lows[kCountingMax], highs[kCountingMax], planars[kCountingMax];
  Stretch stretch;

  inline Ends(const CountingQuery& q, std::uint32_t axis, float from, float to) : stretch{lows, highs, planars, 0, 0, 0, 0, 0, from, to} {
    for (std::uint32_t i = 0; i < q.n; ++i) {
      const float lo = q.references[8 * i + axis], hi = q.references[8 * i + 4 + axis];
      lows[stretch.n_lows] = lo;
      highs[stretch.n_highs] = hi;
      planars[stretch.n_planars] = lo;
      stretch.n_left += lo < from ? 1 : 0;
      stretch.n_right += hi > to ? 1 : 0;
      const std::uint32_t lo_within = lo >= from ? 1U : 0U, hi_within = hi <= to ? 1U : 0U;
      stretch.n_planars += (lo == hi ? 1U : 0U) & lo_within & hi_within;
      stretch.n_lows += lo_within & (lo <= to ? 1U : 0U);
      stretch.n_highs += hi_within & (hi >= from ? 1U : 0U);
    }
  }
};

/// More marks for more triangles than this.
constexpr std::uint32_t kFewTriangles = 24;

/// Adds the planes with triangles on both sides that may be the cheapest; gives what the cheapest
/// costs at most, or the threshold.
template <std::uint32_t kMarks>
inline float add_cheapest(const CountingQuery& q, const AxisOfCell& a, const Extremes& e, float threshold,
                          CountedPlanes& result) {
  const Marks<kMarks> marks(q, a, e);
  result.operations += std::uint64_t{2} * kMarks * q.n / 4;
  const float wanted = wanted_of(a, threshold);
  std::uint32_t begin = 0, end = kMarks;
  while (begin < end && marks.least[begin] > wanted) ++begin;
  while (begin < end && marks.least[end - 1] > wanted) --end;
  if (begin == end) return threshold;
  Ends ends(q, a.axis, marks.at[begin], marks.at[end]);
  ends.stretch.after = e.first[a.axis];
  ends.stretch.before = e.last[a.axis];
  result.operations += operations_of(ends.stretch);
  return add_planes(a, ends.stretch, threshold, threshold, result);
}

// With triangles on both sides, N_left + N_right is N at least and the areas are those of the cell
// and of the plane together, so a split costs no less than step + (cap + side) + cap (N - 1). Where
// that is more than a leaf or cutting off empty space costs, nothing is counted.
void count_planes(const CountingQuery& q, CountedPlanes& result) {
  result.size = result.operations = 0;
  const Extremes extremes(q);
  AxisOfCell axes[3];
  EmptyCuts cuts[3];
  float threshold = q.leaf;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    axes[axis] = {axis, static_cast<std::int32_t>(q.n), q.affordable, q.cell_lo[axis], q.per_width[axis], q.cost[axis]};
    if (!q.cost[axis].usable) continue;
    cuts[axis] = EmptyCuts(q, axes[axis], extremes);
    threshold = cuts[axis].least_first < threshold ? cuts[axis].least_first : threshold;
    threshold = cuts[axis].least_last < threshold ? cuts[axis].least_last : threshold;
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const AxisOfCell& a = axes[axis];
    const RoughCost& c = a.cost;
    const float first = extremes.first[axis], last = extremes.last[axis];
    const auto n = static_cast<std::uint32_t>(a.n);
    if (!c.usable) {
      Ends ends(q, axis, q.cell_lo[axis], q.cell_hi[axis]);
      result.operations += operations_of(ends.stretch);
      (void)add_planes(a, ends.stretch, threshold, threshold, result);
      continue;
    }
    const float wanted = wanted_of(a, threshold);
    const EmptyCuts& cut = cuts[axis];
    const auto first_planar = static_cast<std::uint32_t>(cut.planar_first);
    const auto last_planar = static_cast<std::uint32_t>(cut.planar_last);
    if (cut.least_first <= wanted) add_plane(result, axis, first, cut.least_first, 0, n - first_planar, first_planar);
    if (cut.least_last <= wanted) add_plane(result, axis, last, cut.least_last, n - last_planar, 0, last_planar);
    if (!(first < last) || c.step + (c.cap + c.side) + c.cap * static_cast<float>(n - 1) > wanted) continue;
    threshold = n <= kFewTriangles ? add_cheapest<8>(q, a, extremes, threshold, result)
                                   : add_cheapest<16>(q, a, extremes, threshold, result);
  }
}

/// The same for the planes in a bin of a larger cell.
void count_planes_of_bin(const BinPlanesQuery& q, CountedPlanes& result) {
  result.size = result.operations = 0;
  const AxisOfCell a{q.axis, q.n, q.affordable, q.cell_lo, q.per_width, q.cost};
  const Stretch s{q.lows, q.highs, q.planars, q.n_lows, q.n_highs, q.n_planars, q.n_left, q.n_right, q.cell_lo, q.cell_hi};
  result.operations = operations_of(s);
  (void)add_planes(a, s, q.threshold, q.beyond, result);
}

}  // namespace
}  // namespace raykiln::render
