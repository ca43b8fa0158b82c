#include "raykiln/workers/scene_cache.hpp"

#include "cache_state.hpp"

namespace raykiln::server {

std::string_view name(CacheState state) {
  switch (state) {
    case CacheState::kAbsent: return "absent";
    case CacheState::kBuilding: return "building";
    case CacheState::kReady: return "ready";
  }
  return "";
}

SceneCache::SceneCache(const WorkerSettings& settings, Parts parts)
    : state_(std::make_shared<State>(settings, std::move(parts))) {}
SceneCache::~SceneCache() { state_->stop(); }

std::unique_ptr<PrepareTicket> SceneCache::prepare(const std::string& scene_id, const TreeBudget& budget,
                                                   std::function<void(PrepareProgress)> progress,
                                                   std::function<void(Result<ReadyScene>)> done) {
  return state_->prepare(state_, scene_id, budget, {std::move(progress), std::move(done)});
}

CacheState SceneCache::state(const std::string& scene_id, const TreeBudget& budget) const {
  const std::scoped_lock lock(state_->mutex);
  return state_->state(scene_id, budget);
}

PrepareProgress SceneCache::progress(const std::string& scene_id, const TreeBudget& budget) const {
  const std::scoped_lock lock(state_->mutex);
  const auto found = state_->flights.find(ready_key(scene_id, budget));
  return found == state_->flights.end() ? PrepareProgress{} : found->second->progress();
}

std::optional<TreeReport> SceneCache::tree_report(const std::string& scene_id) const {
  const std::scoped_lock lock(state_->mutex);
  const auto found = state_->reports.find(scene_id);
  if (found == state_->reports.end()) return std::nullopt;
  return found->second;
}

void SceneCache::forget(const std::string& scene_id) {
  const std::scoped_lock lock(state_->mutex);
  state_->forget(scene_id);
}

std::uint64_t SceneCache::bytes() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->kept.bytes();
}

}  // namespace raykiln::server
