// The tree of a scene within the budget of a job.
#pragma once

#include <memory>

#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::server {

/// The numbers that shape the tree.
[[nodiscard]] render::BuildParams build_params(const TreeBudget& budget);

/// "tree_too_large" at "/tree/max_bytes" where the builder could not keep to the bytes for certain.
[[nodiscard]] Status check_tree_budget(const render::Scene& scene, const TreeBudget& budget);

/// Null exactly when the runner was asked to stop. Precondition: check_tree_budget() is success.
[[nodiscard]] std::shared_ptr<const render::KdTree> build_tree(const render::Scene& scene, const TreeBudget& budget,
                                                               render::TaskRunner& runner);

[[nodiscard]] TreeFigures tree_figures(const render::BuildStats& stats);

}  // namespace raykiln::server
