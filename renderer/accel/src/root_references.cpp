#include "root_references.hpp"

#include <algorithm>

#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {
namespace {

struct Piece {
  Run run;
  Bounds3f box;
};

void keep_solid_triangles(const BuildContext& context, std::size_t begin, std::size_t end,
                          Piece& piece) {
  piece.run.data = std::make_unique_for_overwrite<Reference[]>(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    const auto id = static_cast<std::uint32_t>(i);
    const auto p = context.corners(id);
    if (has_zero_area(p[0], p[1], p[2])) continue;
    Bounds3f box;
    for (const Vec3f& corner : p) box.grow(corner);
    for (const Vec3f& corner : p) piece.box.grow(corner);
    piece.run.data[piece.run.size++] = make_reference(box, id);
  }
}

}  // namespace

RootInput make_root(BuildContext& context) {
  const std::size_t n = context.mesh.triangles.size();
  std::vector<Piece> pieces((n + kRunSize - 1) / kRunSize);
  context.for_each(pieces.size(), [&](std::size_t i) {
    if (context.stopped()) return;
    keep_solid_triangles(context, i * kRunSize, std::min(n, (i + 1) * kRunSize), pieces[i]);
  });
  RootInput root;
  for (Piece& piece : pieces) {
    if (piece.run.size == 0) continue;
    root.subtree.cell.grow(piece.box.lo);
    root.subtree.cell.grow(piece.box.hi);
    root.subtree.runs.push_back(std::move(piece.run));
  }
  root.dropped_degenerate = n - root.subtree.size();
  return root;
}

}  // namespace raykiln::render
