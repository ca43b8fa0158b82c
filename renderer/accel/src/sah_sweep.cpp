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

std::array<RoughCost, 3> rough_costs(const Bounds3f& cell, const BuildParams& params) {
  const std::array<double, 3> width{extent(cell, 0), extent(cell, 1), extent(cell, 2)};
  // Areas of the faces across each axis.
  const std::array<double, 3> face{width[1] * width[2], width[2] * width[0], width[0] * width[1]};
  const double half_area = face[0] + face[1] + face[2];
  const double per_area = params.k_i / half_area;
  const bool usable = half_area > 0.0 && params.k_i > 1e-30 && params.k_i < 1e30 && params.k_t < 1e30;
  std::array<RoughCost, 3> costs;
  for (std::size_t a = 0; a < 3; ++a) {
    costs[a] = {static_cast<float>(params.k_t), static_cast<float>(face[a] * per_area),
                static_cast<float>((face[(a + 1) % 3] + face[(a + 2) % 3]) * per_area),
                static_cast<float>(params.empty_factor), usable};
  }
  return costs;
}

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
