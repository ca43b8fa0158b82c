// Scenes and trees in memory: built once, shared, bounded.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/base/metrics.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/render/render.hpp"
#include "raykiln/store/store.hpp"
#include "raykiln/workers/local_pool.hpp"
#include "raykiln/workers/scene_intake.hpp"

namespace raykiln::server {

struct TreeReport {
  double build_seconds = 0.0;
  render::BuildStats stats;
};

struct ReadyScene {
  std::shared_ptr<const render::Scene> scene;
  std::shared_ptr<const render::PreparedScene> prepared;
  TreeReport tree;
  bool built_now = false;  ///< false: the tree was there already
  std::string tree_key{};
};

enum class CacheState { kAbsent, kBuilding, kReady };
[[nodiscard]] std::string_view name(CacheState state);  ///< "absent", "building", "ready"

/// SHA-256 over all that the tree is built from (positions, indices, opacity flags where the builder is
/// given any): equal for scenes that differ in camera, lights or materials.
[[nodiscard]] std::string geometry_digest(const render::Scene& scene);

/// While a ticket lives its holder waits for the scene; a build that nobody waits for is stopped.
class PrepareTicket {
 public:
  virtual ~PrepareTicket() = default;
};

/// How a tree is made; a seam for tests. Null exactly when the runner was asked to stop.
using TreeBuilder = std::function<std::shared_ptr<const render::KdTree>(
    const render::Scene&, const TreeBudget&, render::TaskRunner&)>;

/// Single flight for scenes and for trees; a scene is made ready for a budget of its tree, whose key is (geometry digest, build
/// parameters by settled_budget(), kKdTreeVersion): budgets that come to the same share tree and scene. What was imported serves all budgets. Least recently used
/// scenes and trees are dropped beyond the bound; who holds one keeps it. Safe to use from any thread.
class SceneCache {
 public:
  struct Parts {
    Store& store;
    SceneIntake& intake;
    LocalPool& pool;
    const Clock& clock;
    MetricsRegistry& metrics;
    Log log;
    TreeBuilder build{};  ///< empty: build_tree(); is given settled budgets
  };
  SceneCache(const WorkerSettings& settings, Parts parts);
  ~SceneCache();  ///< stops all flights, joins

  /// Calls `done` once, within this call when the scene is ready, else on another thread, unless the
  /// ticket is dropped before; `progress` rarely, before `done`. Both must only post, and must own
  /// what they touch: a call that is under way when the ticket is dropped still ends. Errors: those of the
  /// store, of SceneIntake::load and of check_tree_budget().
  [[nodiscard]] std::unique_ptr<PrepareTicket> prepare(
      const std::string& scene_id, const TreeBudget& budget,
      std::function<void(PrepareProgress)> progress, std::function<void(Result<ReadyScene>)> done);

  /// Of the scene with the tree of this budget, not of another's; and how far its preparation is, kNone when there is none.
  [[nodiscard]] CacheState state(const std::string& scene_id, const TreeBudget& budget) const;
  [[nodiscard]] PrepareProgress progress(const std::string& scene_id, const TreeBudget& budget) const;
  /// Statistics of the tree that was last made ready for the scene by this process.
  [[nodiscard]] std::optional<TreeReport> tree_report(const std::string& scene_id) const;
  /// Drops what is kept of a deleted scene.
  void forget(const std::string& scene_id);
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace raykiln::server
