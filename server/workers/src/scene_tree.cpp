#include "raykiln/workers/scene_tree.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/render/limited_tree.hpp"

namespace raykiln::server {

render::BuildParams build_params(const TreeBudget& budget) {
  render::BuildParams params;
  params.max_duplication = budget.references_per_triangle;
  return params;
}

std::uint64_t tree_byte_limit(const render::Scene& scene, const TreeBudget& budget, std::uint64_t wide_bytes) {
  const std::uint64_t asked = budget.max_bytes.value_or(0);
  const double usual = TreeBudget{}.references_per_triangle;
  if (budget.references_per_triangle <= usual) return asked;
  const auto least = static_cast<double>(render::least_tree_bytes(scene, build_params(budget)));
  const std::uint64_t most = std::max(wide_bytes, static_cast<std::uint64_t>(std::ceil(usual * least)));
  return asked == 0 ? most : std::min(asked, most);
}

Status check_tree_budget(const render::Scene& scene, const TreeBudget& budget) {
  if (!budget.max_bytes) return success();
  const std::uint64_t least = render::least_tree_bytes(scene, build_params(budget));
  if (*budget.max_bytes >= least) return success();
  return Error{ErrorKind::kTooLarge, "tree_too_large",
               "a tree of this scene may need " + std::to_string(least) + " bytes, and " +
                   std::to_string(*budget.max_bytes) + " are allowed: allow " + std::to_string(least) +
                   " or more (tree.max_bytes, --tree-bytes), or set no limit",
               "/tree/max_bytes"};
}

TreeBudget settled_budget(const render::Scene& scene, const TreeBudget& budget, std::uint64_t wide_bytes) {
  constexpr double kSteps = 64.0;
  render::BuildLimits limits;
  limits.max_bytes = tree_byte_limit(scene, budget, wide_bytes);
  const double references = render::affordable_references(scene, build_params(budget), limits);
  return {.references_per_triangle = std::max(1.0, std::floor(kSteps * references) / kSteps)};
}

std::shared_ptr<const render::KdTree> build_tree(const render::Scene& scene, const TreeBudget& settled,
                                                 render::TaskRunner& runner) {
  return render::build_scene_tree(scene, build_params(settled), runner);
}

TreeFigures tree_figures(const render::BuildStats& stats) {
  return {stats.references, stats.bytes, stats.live_bytes_peak, stats.splits_over_budget > 0};
}

}  // namespace raykiln::server
