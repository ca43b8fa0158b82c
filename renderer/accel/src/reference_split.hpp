// Splitting a cell: which references go to which side, and clipping those that go to both.
#pragma once

#include "build_context.hpp"
#include "reference.hpp"
#include "sah_sweep.hpp"

namespace raykiln::render {

class ReferenceSplit {
 public:
  ReferenceSplit(const BuildContext& context, const Bounds3f& cell, const SplitPlane& plane);

  struct Sizes {
    std::size_t left = 0, right = 0;
    std::uint64_t clips = 0;
  };

  /// Writes what goes left and right, in order. A triangle on both sides whose clipped part is empty
  /// on one is not referenced there. Both outputs have room for from.size(); `left` may be `from`
  /// itself, at its beginning.
  [[nodiscard]] Sizes run(std::span<const Reference> from, Reference* left, Reference* right) const;

  /// Sides before clipping: at least what `run` writes.
  [[nodiscard]] Sizes count(std::span<const Reference> from) const;

  [[nodiscard]] const Bounds3f& left_cell() const { return left_; }
  [[nodiscard]] const Bounds3f& right_cell() const { return right_; }

 private:
  // Wald & Havran 2006, algorithm 6: a triangle in the plane goes to the side that was chosen for
  // all such, one that only touches it stays where it is.
  void clip(SplitCounts& block, Reference* left, Reference* right) const;

  const BuildContext& context_;
  Bounds3f left_, right_;
  SplitQuery query_;
  ClipQuery clip_;
};

}  // namespace raykiln::render
