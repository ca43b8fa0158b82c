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

class Chooser {
 public:
  Chooser(int axis, const SweepInput& input, const BuildParams& params)
      : axis_(axis), input_(input), cost_(input.cell, axis, params) {}

  void consider(float position, std::uint32_t n_left, std::uint32_t n_right, bool planar_left) {
    const double cost = cost_.of(position, n_left, n_right);
    if (!(cost < result.best.cost)) return;
    const std::uint64_t references = std::uint64_t{n_left} + n_right;
    if (references > input_.n && references - input_.n > input_.budget) {
      if (cost < result.unaffordable) result.unaffordable = cost;
      return;
    }
    result.best = {axis_, position, planar_left, n_left, n_right, cost};
  }

  SweepResult result;

 private:
  int axis_;
  const SweepInput& input_;
  CellCost cost_;
};

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

double CellCost::of(float position, std::uint32_t n_left, std::uint32_t n_right) const {
  const auto p = static_cast<double>(position);
  const double area_left = cap_area_ + half_girth_ * (p - lo_);
  const double area_right = cap_area_ + half_girth_ * (hi_ - p);
  const double cost = k_t_ + k_i_over_area_ * (area_left * n_left + area_right * n_right);
  return n_left == 0 || n_right == 0 ? cost * empty_factor_ : cost;
}

SweepResult sweep_axis(std::span<const EventKey> events, int axis, const SweepInput& input,
                       BuildContext& context) {
  Chooser chooser(axis, input, context.params);
  const float lo = input.cell.lo[axis];
  const float hi = input.cell.hi[axis];
  std::uint32_t n_left = 0;
  std::uint32_t n_right = input.n;
  std::size_t next_look = kStopInterval;
  for (std::size_t i = 0; i < events.size();) {
    if (i >= next_look) {
      if (context.stopped()) break;
      next_look = i + kStopInterval;
    }
    const float position = rank_to_float(event_rank(events[i]));
    const Group group = take_group(events, i);
    n_right -= group.planars + group.ends;
    if (lo < position && position < hi) {
      chooser.consider(position, n_left + group.planars, n_right, true);
      if (group.planars > 0) chooser.consider(position, n_left, n_right + group.planars, false);
    }
    n_left += group.starts + group.planars;
  }
  return chooser.result;
}

}  // namespace raykiln::render
