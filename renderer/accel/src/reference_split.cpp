#include "reference_split.hpp"

#include <algorithm>

namespace raykiln::render {
namespace {

Bounds3f cut_off(Bounds3f cell, int axis, float position, bool above) {
  (above ? cell.hi : cell.lo)[axis] = position;
  return cell;
}

}  // namespace

ReferenceSplit::ReferenceSplit(const BuildContext& context, const Bounds3f& cell,
                               const SplitPlane& plane)
    : context_(context),
      left_(cut_off(cell, plane.axis, plane.position, true)),
      right_(cut_off(cell, plane.axis, plane.position, false)),
      parts_(left_, right_, plane.axis),
      query_{plane.position, static_cast<std::uint32_t>(plane.axis), plane.planar_left ? 1U : 0U} {}

// What is on both sides is clipped behind each block, where it stands.
ReferenceSplit::Sizes ReferenceSplit::run(std::span<const Reference> from, Reference* left,
                                          Reference* right) const {
  SplitCounts block;
  Sizes sizes;
  for (; !from.empty(); from = from.subspan(std::min(kSplitBlock, from.size()))) {
    const auto n = static_cast<std::uint32_t>(std::min(kSplitBlock, from.size()));
    Reference* const to_left = left + sizes.left;
    Reference* const to_right = right + sizes.right;
    context_.kernels.split_references(query_, words_of(from.data()), n, words_of(to_left),
                                      words_of(to_right), block);
    sizes.clips += 2 * std::uint64_t{block.n_both};
    if (block.n_both > 0) clip(block, to_left, to_right);
    sizes.left += block.left;
    sizes.right += block.right;
  }
  return sizes;
}

ReferenceSplit::Sizes ReferenceSplit::count(std::span<const Reference> from) const {
  Sizes sizes;
  for (const Reference& r : from) {
    const auto before = static_cast<unsigned>(r.lo[query_.axis] < query_.position);
    const auto behind = static_cast<unsigned>(r.hi[query_.axis] > query_.position);
    const unsigned planar = (before | behind) ^ 1U;
    sizes.left += before | (planar & query_.planar_left);
    sizes.right += behind | (planar & ~query_.planar_left);
  }
  return sizes;
}

void ReferenceSplit::clip(SplitCounts& block, Reference* left, Reference* right) const {
  constexpr std::uint32_t kNothing = 0xFFFFFFFFU;
  const std::span both(block.both, block.n_both);
  bool nothing_left = false;
  bool nothing_right = false;
  for (const auto& place : both) context_.prefetch(left[place.left].triangle);
  for (const auto& place : both) {
    Reference& in_left = left[place.left];
    Reference& in_right = right[place.right];
    const std::uint32_t triangle = in_left.triangle;
    const auto found = parts_.run(context_.corners(triangle), in_left, in_right);
    in_left.triangle = found.left ? triangle : kNothing;
    in_right.triangle = found.right ? triangle : kNothing;
    nothing_left |= !found.left;
    nothing_right |= !found.right;
  }
  const auto drop = [](Reference* side, std::uint32_t first, std::uint32_t& size) {
    const auto is_nothing = [](const Reference& r) { return r.triangle == kNothing; };
    size = static_cast<std::uint32_t>(std::remove_if(side + first, side + size, is_nothing) - side);
  };
  if (nothing_left) drop(left, both[0].left, block.left);
  if (nothing_right) drop(right, both[0].right, block.right);
}

}  // namespace raykiln::render
