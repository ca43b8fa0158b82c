// The surface area heuristic and the sweep that finds its best plane on one axis.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "build_context.hpp"
#include "event_key.hpp"

namespace raykiln::render {

/// A plane and on which side the triangles that lie in it go.
struct SplitPlane {
  int axis = -1;  ///< -1: none
  float position = 0.0F;
  bool planar_left = false;
  std::uint32_t n_left = 0;
  std::uint32_t n_right = 0;
  double cost = std::numeric_limits<double>::infinity();
};

/// Areas that the cost of any plane across one axis of a cell needs; in double, so that the gain
/// of a small split in a huge cell is not lost.
class CellCost {
 public:
  CellCost(const Bounds3f& cell, int axis, const BuildParams& params);

  /// C = k_t + k_i (SA_l/SA N_l + SA_r/SA N_r), times the empty factor when a side is empty
  /// (Wald & Havran 2006, equations 2 and 5). Not a number for a cell without area.
  [[nodiscard]] double of(float position, std::uint32_t n_left, std::uint32_t n_right) const {
    const double cost = before_factor(static_cast<double>(position), n_left, n_right);
    return n_left == 0 || n_right == 0 ? cost * empty_factor_ : cost;
  }
  [[nodiscard]] double before_factor(double p, double n_left, double n_right) const {
    const double area_left = cap_area_ + half_girth_ * (p - lo_);
    const double area_right = cap_area_ + half_girth_ * (hi_ - p);
    return k_t_ + k_i_over_area_ * (area_left * n_left + area_right * n_right);
  }

  /// No plane between two positions costs less, when at least so many of n triangles are left and
  /// right of it. Areas are linear between them, and the other triangles are on one side at least.
  [[nodiscard]] double at_least(float from, float to, std::uint32_t n_left, std::uint32_t n_right,
                                std::uint32_t n) const {
    const double left = n_left, right = n_right;
    const double rest = std::max(0.0, static_cast<double>(n) - left - right);
    const auto at = [&](double p) {
      const double area_left = cap_area_ + half_girth_ * (p - lo_);
      const double area_right = cap_area_ + half_girth_ * (hi_ - p);
      return area_left * left + area_right * right + std::min(area_left, area_right) * rest;
    };
    const double sides = std::min(at(static_cast<double>(from)), at(static_cast<double>(to)));
    const double cost = (k_t_ + k_i_over_area_ * sides) * (1.0 - 0x1p-40);
    return n_left == 0 || n_right == 0 ? cost * empty_factor_ : cost;
  }

 private:
  double lo_, hi_, cap_area_, half_girth_, k_t_, k_i_over_area_, empty_factor_;
};

/// The same for the kernels, of all three axes.
[[nodiscard]] std::array<RoughCost, 3> rough_costs(const Bounds3f& cell, const BuildParams& params);

/// Surface area of a box, in double.
[[nodiscard]] double surface_area(const Bounds3f& box);

struct SweepInput {
  Bounds3f cell;
  std::uint32_t n = 0;         ///< triangles in the cell
  std::uint64_t budget = 0;    ///< additional references that a split may make
};

struct SweepResult {
  SplitPlane best;             ///< cheapest plane within the budget; the first of equals
  double unaffordable = std::numeric_limits<double>::infinity();  ///< cheapest one beyond it
};

/// The best of the axes, which come in their order: the first of equals.
struct BestOfAxes {
  SweepResult result;
  void take(const SweepResult& of_axis) {
    if (of_axis.best.cost < result.best.cost) result.best = of_axis.best;
    if (of_axis.unaffordable < result.unaffordable) result.unaffordable = of_axis.unaffordable;
  }
};

/// Takes planes of one axis in any order and keeps the cheapest; of equals the one at the lowest
/// position, and there the one offered first.
class PlaneChooser {
 public:
  PlaneChooser(int axis, const SweepInput& input, const BuildParams& params)
      : cost_(input.cell, axis, params), input_(&input), axis_(axis) {}

  void consider(float position, std::uint32_t n_left, std::uint32_t n_right, bool planar_left) {
    const double cost = cost_.of(position, n_left, n_right);
    const SplitPlane& best = result_.best;
    const bool ahead = cost == best.cost && best.axis >= 0 && position < best.position;
    if (!(cost < best.cost) && !ahead) return;
    const std::uint64_t references = std::uint64_t{n_left} + n_right;
    if (references > input_->n && references - input_->n > input_->budget) {
      if (cost < result_.unaffordable) result_.unaffordable = cost;
      return;
    }
    result_.best = {axis_, position, planar_left, n_left, n_right, cost};
  }

  [[nodiscard]] const SweepResult& result() const { return result_; }
  [[nodiscard]] const CellCost& cost() const { return cost_; }
  [[nodiscard]] int axis() const { return axis_; }

 private:
  CellCost cost_;
  const SweepInput* input_;
  SweepResult result_;
  int axis_;
};

/// Adds the one or two events of an extent.
inline void append_events(float lo, float hi, std::uint32_t id, std::vector<EventKey>& events) {
  if (event_rank(make_event(lo, EventType::kPlanar, 0)) ==
      event_rank(make_event(hi, EventType::kPlanar, 0))) {
    events.push_back(make_event(lo, EventType::kPlanar, id));
    return;
  }
  events.push_back(make_event(lo, EventType::kStart, id));
  events.push_back(make_event(hi, EventType::kEnd, id));
}

/// Offers all planes at sorted events that stand strictly inside the cell: a plane in a face of it
/// would make a flat child. `n_left` triangles begin and `n_gone` end before the first event.
void sweep(std::span<const EventKey> events, const SweepInput& input, int axis,
           std::uint32_t n_left, std::uint32_t n_gone, PlaneChooser& chooser);

/// The best plane by all sorted events of an axis.
[[nodiscard]] SweepResult sweep_axis(std::span<const EventKey> events, int axis,
                                     const SweepInput& input, const BuildParams& params);

}  // namespace raykiln::render
