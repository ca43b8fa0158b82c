#include "reference_split.hpp"

#include "polygon_clip.hpp"

namespace raykiln::render {

ReferenceSplit::ReferenceSplit(const BuildContext& context, const Bounds3f& cell,
                               const SplitPlane& plane)
    : context_(context),
      left_(cell),
      right_(cell),
      axis_(static_cast<std::size_t>(plane.axis)),
      position_(plane.position),
      planar_left_(plane.planar_left) {
  left_.hi[plane.axis] = right_.lo[plane.axis] = plane.position;
}

ReferenceSplit::Sizes ReferenceSplit::run(std::span<const Reference> from, Reference* left,
                                          Reference* right) const {
  Sizes sizes;
  for (const Reference& source : from) {
    const Reference r = source;  // `left` may stand on it
    const bool to_left = goes_left(r);
    const bool to_right = goes_right(r);
    if (to_left && to_right) {
      sizes.clips += 2;
      sizes.left += clip(r, left_, left[sizes.left]) ? 1U : 0U;
      sizes.right += clip(r, right_, right[sizes.right]) ? 1U : 0U;
      continue;
    }
    left[sizes.left] = r;  // always written, kept only when counted: no branch to mispredict
    right[sizes.right] = r;
    sizes.left += to_left ? 1U : 0U;
    sizes.right += to_right ? 1U : 0U;
  }
  return sizes;
}

ReferenceSplit::Sizes ReferenceSplit::count(std::span<const Reference> from) const {
  Sizes sizes;
  for (const Reference& r : from) {
    sizes.left += goes_left(r) ? 1U : 0U;
    sizes.right += goes_right(r) ? 1U : 0U;
  }
  return sizes;
}

bool ReferenceSplit::clip(const Reference& r, const Bounds3f& cell, Reference& to) const {
  const auto box = clipped_bounds(context_.corners(r.triangle), cell);
  if (!box) return false;
  to = make_reference(*box, r.triangle);
  return true;
}

}  // namespace raykiln::render
