#include "root_events.hpp"

#include <algorithm>

#include "key_sort.hpp"
#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {
namespace {

void keep_solid_triangles(BuildContext& context, RootInput& root) {
  const std::size_t n = context.mesh.triangles.size();
  root.subtree.ids.reserve(n);
  context.in_pieces(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto id = static_cast<std::uint32_t>(i);
      const auto p = context.corners(id);
      if (has_zero_area(p[0], p[1], p[2])) {
        ++root.dropped_degenerate;
        continue;
      }
      root.subtree.ids.push_back(id);
      for (const Vec3f& corner : p) root.subtree.cell.grow(corner);
    }
  });
}

void make_axis_events(BuildContext& context, int axis, const std::vector<std::uint32_t>& ids,
                      std::vector<EventKey>& events) {
  events.reserve(2 * ids.size());
  context.in_pieces(ids.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto p = context.corners(ids[i]);
      const float lo = std::min({p[0][axis], p[1][axis], p[2][axis]});
      const float hi = std::max({p[0][axis], p[1][axis], p[2][axis]});
      append_events(lo, hi, static_cast<std::uint32_t>(i), events);
    }
  });
}

}  // namespace

RootInput make_root(BuildContext& context) {
  RootInput root;
  keep_solid_triangles(context, root);
  const auto& ids = root.subtree.ids;
  std::array<std::uint64_t, 3> operations{};
  context.for_each_axis(ids.size() >= kParallelMin, [&](int axis) {
    const auto a = static_cast<std::size_t>(axis);
    make_axis_events(context, axis, ids, root.subtree.events[a]);
    std::vector<std::uint64_t> scratch;
    operations[a] = sort_keys(root.subtree.events[a], kEventIdBits, scratch, &context);
  });
  root.sort_operations = operations[0] + operations[1] + operations[2];
  return root;
}

}  // namespace raykiln::render
