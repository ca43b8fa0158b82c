// The inside of the scene cache.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <variant>
#include <vector>

#include "byte_lru.hpp"
#include "flight.hpp"
#include "raykiln/workers/scene_cache.hpp"

namespace raykiln::server {

struct BuiltTree {
  std::shared_ptr<const render::KdTree> tree;
  TreeReport report;
};

/// One build under way; it goes on while any of its flights is wanted.
struct TreeFlight {
  std::set<std::shared_ptr<Flight>> flights;  ///< guarded by the cache's mutex
  bool ended = false;
};

/// How the keys begin of all that is kept of a scene.
[[nodiscard]] std::string scene_key(const std::string& scene_id);
/// Of what is under way with a budget as it was asked for, and of what is ready with a settled one.
[[nodiscard]] std::string ready_key(const std::string& scene_id, const TreeBudget& budget);

struct SceneCache::State {
 public:
  State(const WorkerSettings& settings, Parts parts);

  [[nodiscard]] std::unique_ptr<PrepareTicket> prepare(
      const std::shared_ptr<State>& self, const std::string& scene_id, const TreeBudget& budget,
      Flight::Waiter waiter);
  void drop(const std::shared_ptr<Flight>& flight, std::uint64_t waiter);
  void stop();
  /// Preconditions of these: the mutex is held.
  [[nodiscard]] CacheState state(const std::string& scene_id, const TreeBudget& budget) const;
  void forget(const std::string& scene_id);

  /// Work of one preparing thread.
  void work();

  mutable std::mutex mutex;
  std::map<std::string, std::shared_ptr<Flight>> flights;  ///< newest of each ready_key()
  std::map<std::string, TreeReport> reports;               ///< by scene
  using ImportedScene = std::shared_ptr<const render::Scene>;
  using Kept = std::variant<ReadyScene, BuiltTree, ImportedScene>;
  ByteLru<Kept> kept;

 private:
  struct NewTree {
    BuiltTree tree;
    bool built_now = false;
  };
  [[nodiscard]] Result<ReadyScene> fly(const std::shared_ptr<Flight>& flight);
  [[nodiscard]] Result<ReadyScene> guarded_fly(const std::shared_ptr<Flight>& flight);
  [[nodiscard]] std::optional<ReadyScene> ready(const std::string& scene_id, const TreeBudget& budget);
  [[nodiscard]] std::optional<std::string> kept_key(const std::string& scene_id, const TreeBudget& budget) const;
  [[nodiscard]] Result<ImportedScene> imported(const Flight& flight);
  [[nodiscard]] ImportedScene keep_imported(const std::string& scene_id, ImportedScene scene,
                                            const std::string& beside);
  void end(const std::shared_ptr<Flight>& flight);
  [[nodiscard]] Result<NewTree> obtain_tree(const std::shared_ptr<Flight>& flight,
                                            const render::Scene& scene, const TreeBudget& settled,
                                            const std::string& key);
  [[nodiscard]] std::optional<BuiltTree> build(TreeFlight& tree_flight, const render::Scene& scene,
                                               const TreeBudget& budget);
  [[nodiscard]] bool is_wanted(const TreeFlight& tree_flight) const;
  void report(const TreeFlight& tree_flight, double fraction) const;
  void keep(const std::string& key, Kept value, std::uint64_t bytes,
            std::initializer_list<std::string> beside = {});

  const std::uint64_t wide_tree_bytes_;
  Parts parts_;
  Counter& builds_;
  Counter& imports_;
  Counter& hits_;
  Gauge& bytes_;
  std::condition_variable wake_;       ///< for the preparing threads
  std::condition_variable tree_ended_;
  std::deque<std::shared_ptr<Flight>> queue_;
  std::map<std::string, std::shared_ptr<TreeFlight>> tree_flights_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace raykiln::server
