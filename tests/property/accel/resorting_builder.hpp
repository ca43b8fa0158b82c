// The builder that Wald & Havran (2006, section 4.1) start from, O(N log^2 N): the planes and so the tree
// of the real one, but every cell sorts its events anew. What a test of growth must be able to refuse.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "build_context.hpp"
#include "polygon_clip.hpp"
#include "root_references.hpp"
#include "sah_sweep.hpp"
#include "subtree_builder.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {

struct Resorted {
  std::uint64_t operations = 0;  ///< comparisons, events swept, triangles sent to a side
  std::uint64_t nodes = 0, references = 0;
};

class ResortingBuilder {
 public:
  explicit ResortingBuilder(const TestMesh& mesh) : view_(mesh.view()), context_(view_, {}, runner_) {}

  Resorted run() {
    const render::RootInput root = render::make_root(context_);
    std::vector<Part> parts;
    for (const render::Run& run : root.subtree.runs) {
      for (const render::Reference& reference : run.view()) {
        Part part{reference.triangle, {}};
        for (const Vec3f& corner : context_.corners(part.id)) part.box.grow(corner);
        parts.push_back(part);
      }
    }
    const auto n = static_cast<double>(parts.size());
    const auto budget = static_cast<std::uint64_t>((context_.params.max_duplication - 1.0) * n);
    max_depth_ = render::depth_cap(context_.params.max_depth, parts.size());
    build(root.subtree.cell, std::move(parts), 0, budget);
    return result_;
  }

 private:
  struct Part {
    std::uint32_t id;
    render::Bounds3f box;  ///< of what of the triangle lies in the cell
  };

  void build(const render::Bounds3f& cell, std::vector<Part> parts, int depth, std::uint64_t budget) {
    ++result_.nodes;
    const render::SplitPlane plane = choose(cell, parts, depth, budget);
    if (plane.axis < 0) {
      result_.references += parts.size();
      return;
    }
    render::Bounds3f left_cell = cell, right_cell = cell;
    left_cell.hi[plane.axis] = right_cell.lo[plane.axis] = plane.position;
    std::vector<Part> left, right;
    for (const Part& part : parts) send(part, plane, left_cell, right_cell, left, right);
    result_.operations += parts.size();
    const std::uint64_t total = left.size() + right.size();
    const std::uint64_t added = total > parts.size() ? total - parts.size() : 0;
    const std::uint64_t rest = budget - std::min(budget, added);
    const std::uint64_t left_budget =
        total == 0 ? 0 : rest / total * left.size() + rest % total * left.size() / total;
    parts = {};
    build(left_cell, std::move(left), depth + 1, left_budget);
    build(right_cell, std::move(right), depth + 1, rest - left_budget);
  }

  void send(const Part& part, const render::SplitPlane& plane, const render::Bounds3f& left_cell,
            const render::Bounds3f& right_cell, std::vector<Part>& left, std::vector<Part>& right) {
    const float lo = part.box.lo[plane.axis], hi = part.box.hi[plane.axis], at = plane.position;
    if (lo == hi ? lo < at || (lo == at && plane.planar_left) : hi <= at) {
      left.push_back(part);
    } else if (lo >= at) {
      right.push_back(part);
    } else {
      const auto corners = context_.corners(part.id);
      if (const auto box = render::clipped_bounds(corners, left_cell)) left.push_back({part.id, *box});
      if (const auto box = render::clipped_bounds(corners, right_cell)) right.push_back({part.id, *box});
    }
  }

  render::SplitPlane choose(const render::Bounds3f& cell, const std::vector<Part>& parts, int depth,
                            std::uint64_t budget) {
    const render::BuildParams& params = context_.params;
    const double leaf_cost = params.k_i * static_cast<double>(parts.size());
    if (parts.empty() || leaf_cost <= params.k_t * params.empty_factor) return {};
    render::SplitPlane best;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<render::EventKey> events;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        render::append_events(parts[i].box.lo[axis], parts[i].box.hi[axis],
                              static_cast<std::uint32_t>(i), events);
      }
      std::sort(events.begin(), events.end(), [this](render::EventKey a, render::EventKey b) {
        ++result_.operations;
        return a < b;
      });
      const auto found = render::sweep_axis(
          events, axis, {cell, static_cast<std::uint32_t>(parts.size()), budget}, params);
      result_.operations += events.size();
      if (found.best.cost < best.cost) best = found.best;
    }
    return best.cost < leaf_cost && depth < max_depth_ ? best : render::SplitPlane{};
  }

  render::TriangleView view_;
  render::SerialTaskRunner runner_;
  render::BuildContext context_;
  int max_depth_ = 0;
  Resorted result_;
};

}  // namespace raykiln::test
