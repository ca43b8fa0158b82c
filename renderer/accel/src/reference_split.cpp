#include "reference_split.hpp"

#include <algorithm>

namespace raykiln::render {
namespace {

Bounds3f cut_off(Bounds3f cell, int axis, float position, bool above) {
  (above ? cell.hi : cell.lo)[axis] = position;
  return cell;
}

static_assert(sizeof(Vec3f) == 3 * sizeof(float));

ClipQuery clip_query(const TriangleView& mesh, const Bounds3f& left, const Bounds3f& right,
                     std::uint32_t axis) {
  ClipQuery query{};
  query.positions = mesh.positions.empty() ? nullptr : &mesh.positions[0].x;
  query.triangles = mesh.triangles.empty() ? nullptr : mesh.triangles[0].data();
  query.axis = axis;
  for (int k = 0; k < 3; ++k) {
    query.left[0][k] = left.lo[k];
    query.left[1][k] = left.hi[k];
    query.right[0][k] = right.lo[k];
    query.right[1][k] = right.hi[k];
  }
  return query;
}

}  // namespace

ReferenceSplit::ReferenceSplit(const BuildContext& context, const Bounds3f& cell,
                               const SplitPlane& plane)
    : context_(context),
      left_(cut_off(cell, plane.axis, plane.position, true)),
      right_(cut_off(cell, plane.axis, plane.position, false)),
      query_{plane.position, static_cast<std::uint32_t>(plane.axis), plane.planar_left ? 1U : 0U},
      clip_(clip_query(context.mesh, left_, right_, query_.axis)) {}

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
  const unsigned complete = context_.kernels.clip_references(clip_, block.both, block.n_both,
                                                             words_of(left), words_of(right));
  const auto drop = [](Reference* side, std::uint32_t first, std::uint32_t& size) {
    const auto is_nothing = [](const Reference& r) { return r.triangle == kNoReference; };
    size = static_cast<std::uint32_t>(std::remove_if(side + first, side + size, is_nothing) - side);
  };
  if ((complete & 1U) == 0) drop(left, block.both[0].left, block.left);
  if ((complete & 2U) == 0) drop(right, block.both[0].right, block.right);
}

}  // namespace raykiln::render
