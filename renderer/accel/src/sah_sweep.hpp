// The surface area heuristic and the sweep that finds its best plane on one axis.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

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
  [[nodiscard]] double of(float position, std::uint32_t n_left, std::uint32_t n_right) const;

 private:
  double lo_, hi_, cap_area_, half_girth_, k_t_, k_i_over_area_, empty_factor_;
};

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

/// Candidates are the event positions strictly inside the cell: a plane in a face of the cell
/// would make a flat child.
[[nodiscard]] SweepResult sweep_axis(std::span<const EventKey> events, int axis,
                                     const SweepInput& input, BuildContext& context);

}  // namespace raykiln::render
