// What clients ask about scenes.
#include "core.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/effects.hpp"

namespace raykiln::server {

SceneView Scheduler::Core::view(SceneRecord record) const {
  SceneView view;
  view.report = decode_report(record.report).value_or(SceneReport{});
  view.cache = parts_.cache.state(record.id, {});
  view.prepare = parts_.cache.progress(record.id, {});
  view.tree = parts_.cache.tree_report(record.id);
  view.record = std::move(record);
  return view;
}

void Scheduler::Core::add_scene(std::shared_ptr<std::unique_ptr<SceneUpload>> upload,
                                const AddSceneOptions& options, const Reply<AddedScene>& reply) {
  const std::string id = (*upload)->id();
  if (!options.expected_digest.empty() && options.expected_digest != id) {
    return reply(Error{ErrorKind::kInvalid, "digest_mismatch", "the bytes hash to " + id, ""});
  }
  if (auto known = parts_.store.scene(id)) {
    return reply(AddedScene{view(std::move(*known)), false});
  }
  if (!accepting_) {
    return reply(Error{ErrorKind::kUnavailable, "shutting_down", "the server is stopping", "", 5});
  }
  if (pending_imports_ >= config_.workers.max_pending_imports) {
    return reply(Error{ErrorKind::kTooMany, "too_many_uploads", "too many scenes wait for their import",
                       "", 5});
  }
  ++pending_imports_;
  intake_.post([this, upload, options, reply] { import_scene(upload, options, reply); });
}

/// On the intake's thread.
void Scheduler::Core::import_scene(std::shared_ptr<std::unique_ptr<SceneUpload>> upload,
                                   const AddSceneOptions& options, const Reply<AddedScene>& reply) {
  const auto import = [&]() -> Result<AddedScene> {
    const std::string id = (*upload)->id();
    const auto missing =
        options.allow_missing ? MissingTextures::kLeaveOut : MissingTextures::kRefuse;
    auto loaded = parts_.intake.load((*upload)->kind(), (*upload)->files(), missing, {});
    if (!loaded) return loaded.error();
    auto created = parts_.store.commit_scene(std::move(*upload), options.name, parts_.clock.wall(),
                                             encode_report(loaded->report));
    if (!created) return created.error();
    auto record = parts_.store.scene(id);
    if (!record) return record.error();
    parts_.log.info("scene_added", {{"scene", id}, {"triangles", loaded->report.triangles}});
    return AddedScene{view(std::move(*record)), *created};
  };
  Result<AddedScene> result = Error{};
  try {
    result = import();
  } catch (const std::exception& fault) {
    result = Error{ErrorKind::kInternal, "internal", fault.what(), ""};
  }
  upload->reset();  // a refused upload is gone before its answer
  strand_->post([this] { --pending_imports_; });
  reply(std::move(result));
}

void Scheduler::Core::scene(const std::string& id, const Reply<SceneView>& reply) {
  auto record = parts_.store.scene(id);
  if (!record) return reply(record.error());
  reply(view(std::move(*record)));
}

void Scheduler::Core::scenes(std::size_t offset, std::size_t limit,
                             const Reply<std::vector<SceneView>>& reply) {
  auto records = parts_.store.scenes(offset, limit);
  if (!records) return reply(records.error());
  std::vector<SceneView> views;
  for (SceneRecord& record : *records) views.push_back(view(std::move(record)));
  reply(std::move(views));
}

void Scheduler::Core::delete_scene(const std::string& id, const Reply<std::monostate>& reply) {
  for (const auto& entry : live_) {
    if (entry.second->snapshot.request.scene == id) {
      return reply(Error{ErrorKind::kConflict, "scene_in_use", "an unfinished job needs the scene",
                         entry.first});
    }
  }
  std::erase_if(prepares_, [&](const auto& entry) { return entry.first.first == id; });
  auto deleted = parts_.store.delete_scene(id);
  if (deleted) parts_.cache.forget(id);
  reply(std::move(deleted));
}

/// Makes scene and tree ready, if they are not and nobody is at it for a client yet. What went wrong the last time
/// is told once; who asks again after that has it tried again.
Status Scheduler::Core::begin_preparing(const std::string& id, const TreeBudget& budget) {
  if (!accepting_) {
    return Error{ErrorKind::kUnavailable, "shutting_down", "the server is stopping", "", 5};
  }
  const auto key = std::pair(id, tree_budget_text(budget));
  if (parts_.cache.state(id, budget) == CacheState::kReady) return success();
  if (const auto known = prepares_.find(key); known != prepares_.end()) {
    if (!known->second.fault) return success();
    const Error fault = *known->second.fault;
    prepares_.erase(known);
    return fault;
  }
  if (prepares_.size() >= config_.workers.max_pending_imports) {
    std::erase_if(prepares_, [](const auto& entry) { return entry.second.fault.has_value(); });  // nobody came back
  }
  if (prepares_.size() >= config_.workers.max_pending_imports) {
    return Error{ErrorKind::kTooMany, "too_many_uploads", "too many scenes are being prepared", "", 5};
  }
  auto done = [this, strand = strand_, key](const Result<ReadyScene>& scene) {
    post_on(strand, this, [this, key, fault = scene ? std::nullopt : std::optional(scene.error())] {
      const auto mine = prepares_.find(key);
      if (mine == prepares_.end()) return;  // the scene was deleted
      if (fault) mine->second = {nullptr, fault};
      else prepares_.erase(mine);
    });
  };
  prepares_[key].ticket = parts_.cache.prepare(id, budget, {}, std::move(done));
  return success();
}

void Scheduler::Core::prepare_scene(const std::string& id, const Reply<SceneView>& reply) {
  auto record = parts_.store.scene(id);
  if (!record) return reply(record.error());
  if (auto begun = begin_preparing(id, {}); !begun) return reply(begun.error());
  reply(view(std::move(*record)));
}

/// What the cache has, without waiting for anything.
std::optional<ReadyScene> Scheduler::Core::scene_in_memory(const std::string& id, const TreeBudget& budget) {
  if (parts_.cache.state(id, budget) != CacheState::kReady) return std::nullopt;
  // The scene may be dropped in between: then the answer would come later, to nobody.
  struct Answer {
    std::mutex mutex;
    std::optional<ReadyScene> scene;
  };
  const auto answer = std::make_shared<Answer>();
  const auto ticket = parts_.cache.prepare(id, budget, {}, [answer](Result<ReadyScene> ready) {
    const std::scoped_lock lock(answer->mutex);
    if (ready) answer->scene = std::move(*ready);
  });
  const std::scoped_lock lock(answer->mutex);
  return answer->scene;
}

void Scheduler::Core::replay_inputs(const JobId& id, const Reply<ReplayInputs>& reply) {
  auto job = snapshot_of(id);
  if (!job) return reply(job.error());
  const JobRequest& request = job->request;
  LiveJob* live = find(id);
  auto scene = live != nullptr && live->scene.prepared ? std::optional(live->scene)
                                                       : scene_in_memory(request.scene, request.tree);
  if (!scene) {
    if (auto record = parts_.store.scene(request.scene); !record) return reply(record.error());
    // That would come out again, of as much work: the job has said it with the remedy.
    if (job->error && job->error->code == "tree_too_large") return reply(*job->error);
    if (auto begun = begin_preparing(request.scene, request.tree); !begun) return reply(begun.error());
    return reply(Error{ErrorKind::kUnavailable, "scene_not_ready",
                       "scene and tree of the job are being made ready", request.scene, 1});
  }
  auto settings = render_settings(request, *scene->scene);
  if (!settings) return reply(settings.error());
  reply(ReplayInputs{scene->prepared, *settings,
                     effect_report(render::effect_plan(*settings, *scene->prepared))});
}

}  // namespace raykiln::server
