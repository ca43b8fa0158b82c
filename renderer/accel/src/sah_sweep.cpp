#include "sah_sweep.hpp"

namespace raykiln::render {
namespace {

double extent(const Bounds3f& box, int axis) {
  return static_cast<double>(box.hi[axis]) - static_cast<double>(box.lo[axis]);
}

// How many events of each type stand at the position of events[i]; i moves behind them.
struct Group {
  std::uint32_t ends = 0, planars = 0, starts = 0;
};

Group take_group(std::span<const EventKey> events, std::size_t& i) {
  Group group;
  const std::uint32_t rank = event_rank(events[i]);
  for (; i < events.size() && event_rank(events[i]) == rank; ++i) {
    const EventType type = event_type(events[i]);
    group.ends += type == EventType::kEnd ? 1U : 0U;
    group.planars += type == EventType::kPlanar ? 1U : 0U;
    group.starts += type == EventType::kStart ? 1U : 0U;
  }
  return group;
}

}  // namespace

double surface_area(const Bounds3f& box) {
  const double x = extent(box, 0);
  const double y = extent(box, 1);
  const double z = extent(box, 2);
  return 2.0 * (x * y + y * z + z * x);
}

CellCost::CellCost(const Bounds3f& cell, int axis, const BuildParams& params)
    : lo_(static_cast<double>(cell.lo[axis])),
      hi_(static_cast<double>(cell.hi[axis])),
      cap_area_(2.0 * extent(cell, (axis + 1) % 3) * extent(cell, (axis + 2) % 3)),
      half_girth_(2.0 * (extent(cell, (axis + 1) % 3) + extent(cell, (axis + 2) % 3))),
      k_t_(params.k_t),
      k_i_over_area_(params.k_i / surface_area(cell)),
      empty_factor_(params.empty_factor) {}

void sweep(std::span<const EventKey> events, const SweepInput& input, int axis,
           std::uint32_t n_left, std::uint32_t n_gone, PlaneChooser& chooser) {
  const float lo = input.cell.lo[axis];
  const float hi = input.cell.hi[axis];
  std::uint32_t n_right = input.n - n_gone;
  for (std::size_t i = 0; i < events.size();) {
    const float position = rank_to_float(event_rank(events[i]));
    const Group group = take_group(events, i);
    n_right -= group.planars + group.ends;
    if (lo < position && position < hi) {
      chooser.consider(position, n_left + group.planars, n_right, true);
      if (group.planars > 0) chooser.consider(position, n_left, n_right + group.planars, false);
    }
    n_left += group.starts + group.planars;
  }
}

SweepResult sweep_axis(std::span<const EventKey> events, int axis, const SweepInput& input,
                       const BuildParams& params) {
  PlaneChooser chooser(axis, input, params);
  sweep(events, input, axis, 0, 0, chooser);
  return chooser.result();
}

}  // namespace raykiln::render
