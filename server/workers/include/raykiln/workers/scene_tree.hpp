// The tree of a scene within the budget of a job.
#pragma once

#include <cstdint>
#include <memory>

#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::server {

/// The numbers that shape the tree.
[[nodiscard]] render::BuildParams build_params(const TreeBudget& budget);

/// Most bytes that building the tree may take; 0: no limit. Asking for more references than by default
/// gives as many as `wide_bytes` (WorkerSettings::wide_tree_bytes) or what the default may need at worst,
/// whichever is more, hold for certain: no request takes the server's memory.
[[nodiscard]] std::uint64_t tree_byte_limit(const render::Scene& scene, const TreeBudget& budget, std::uint64_t wide_bytes);

/// What the budget comes to for this scene, without bytes: budgets that come to the same have the same tree. In steps of
/// 1/64 of a reference a triangle, downwards, so that who counts bytes up does not get a tree for each.
/// Precondition: check_tree_budget() is success.
[[nodiscard]] TreeBudget settled_budget(const render::Scene& scene, const TreeBudget& budget, std::uint64_t wide_bytes);

/// "tree_too_large" at "/tree/max_bytes" where the builder could not keep to the bytes for certain.
[[nodiscard]] Status check_tree_budget(const render::Scene& scene, const TreeBudget& budget);

/// Null exactly when the runner was asked to stop. `settled`: by settled_budget().
[[nodiscard]] std::shared_ptr<const render::KdTree> build_tree(const render::Scene& scene, const TreeBudget& settled,
                                                               render::TaskRunner& runner);

[[nodiscard]] TreeFigures tree_figures(const render::BuildStats& stats);

}  // namespace raykiln::server
