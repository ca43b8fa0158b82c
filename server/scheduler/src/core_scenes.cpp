// What clients ask about scenes.
#include "core.hpp"

namespace raykiln::server {

SceneView Scheduler::Core::view(SceneRecord record) const {
  SceneView view;
  view.report = decode_report(record.report).value_or(SceneReport{});
  view.cache = parts_.cache.state(record.id);
  view.prepare = parts_.cache.progress(record.id);
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
    auto loaded = parts_.intake.load((*upload)->kind(), (*upload)->files(), {});
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
  prepares_.erase(id);
  auto deleted = parts_.store.delete_scene(id);
  if (deleted) parts_.cache.forget(id);
  reply(std::move(deleted));
}

void Scheduler::Core::prepare_scene(const std::string& id, const Reply<SceneView>& reply) {
  auto record = parts_.store.scene(id);
  if (!record) return reply(record.error());
  if (!accepting_) {
    return reply(Error{ErrorKind::kUnavailable, "shutting_down", "the server is stopping", "", 5});
  }
  if (parts_.cache.state(id) != CacheState::kReady && !prepares_.contains(id)) {
    if (prepares_.size() >= config_.workers.max_pending_imports) {
      return reply(Error{ErrorKind::kTooMany, "too_many_uploads", "too many scenes are being prepared",
                         "", 5});
    }
    prepares_[id] = parts_.cache.prepare(id, {}, [this, strand = strand_, id](const Result<ReadyScene>&) {
      post_on(strand, this, [this, id] { prepares_.erase(id); });
    });
  }
  reply(view(std::move(*record)));
}

}  // namespace raykiln::server
