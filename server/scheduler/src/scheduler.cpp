#include "raykiln/scheduler/scheduler.hpp"

#include <utility>

#include "core.hpp"

namespace raykiln::server {
namespace {

template <class T, class Core, class Step>
void ask(Core& core, const Reply<T>& reply, Step step) {
  answer_by([&core](auto run) { return core.post(std::move(run)); }, reply, std::move(step));
}

}  // namespace

Scheduler::Scheduler(const Config& config, Parts parts)
    : core_(std::make_unique<Core>(config, parts)) {
  core_->post([core = core_.get()] { core->restore(); });
}
Scheduler::~Scheduler() { shutdown(std::chrono::milliseconds(0)); }

void Scheduler::submit(SubmitJob submission, Reply<SubmittedJob> reply) {
  ask(*core_, reply, [core = core_.get(), s = std::move(submission)](const auto& to) mutable {
    core->submit(std::move(s), to);
  });
}
void Scheduler::extend(ExtendJob extension, Reply<SubmittedJob> reply) {
  ask(*core_, reply, [core = core_.get(), e = std::move(extension)](const auto& to) mutable {
    core->extend(std::move(e), to);
  });
}
void Scheduler::get(JobId id, Reply<JobSnapshot> reply) {
  ask(*core_, reply, [core = core_.get(), id = std::move(id)](const auto& to) { core->get(id, to); });
}
void Scheduler::list(ListJobs query, Reply<JobPage> reply) {
  ask(*core_, reply,
      [core = core_.get(), q = std::move(query)](const auto& to) { core->list(q, to); });
}
void Scheduler::cancel(JobId id, Reply<JobSnapshot> reply) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id)](const auto& to) { core->cancel(id, to); });
}
void Scheduler::watch(JobId id, std::function<void()> wake,
                      Reply<std::unique_ptr<Subscription>> reply, Seat seat) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id), wake = std::move(wake), seat](const auto& to) mutable {
        core->watch(id, std::move(wake), to, seat);
      });
}
void Scheduler::image(JobId id, std::string layer, Reply<JobImagePtr> reply) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id), layer = std::move(layer)](const auto& to) {
        core->image(id, layer, to);
      });
}
void Scheduler::replay_inputs(JobId id, Reply<ReplayInputs> reply) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id)](const auto& to) { core->replay_inputs(id, to); });
}
void Scheduler::add_scene(std::unique_ptr<SceneUpload> upload, AddSceneOptions options,
                          Reply<AddedScene> reply) {
  // Closures are copied, an upload is not.
  auto held = std::make_shared<std::unique_ptr<SceneUpload>>(std::move(upload));
  ask(*core_, reply, [core = core_.get(), held, o = std::move(options)](const auto& to) {
    core->add_scene(held, o, to);
  });
}
void Scheduler::scene(std::string id, Reply<SceneView> reply) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id)](const auto& to) { core->scene(id, to); });
}
void Scheduler::scenes(std::size_t offset, std::size_t limit,
                       Reply<std::vector<SceneView>> reply) {
  ask(*core_, reply,
      [core = core_.get(), offset, limit](const auto& to) { core->scenes(offset, limit, to); });
}
void Scheduler::delete_scene(std::string id, Reply<std::monostate> reply) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id)](const auto& to) { core->delete_scene(id, to); });
}
void Scheduler::prepare_scene(std::string id, Reply<SceneView> reply) {
  ask(*core_, reply,
      [core = core_.get(), id = std::move(id)](const auto& to) { core->prepare_scene(id, to); });
}
void Scheduler::status(Reply<SchedulerStatus> reply) {
  ask(*core_, reply, [core = core_.get()](const auto& to) { core->status(to); });
}
void Scheduler::shutdown(std::chrono::milliseconds drain) { core_->shutdown(drain); }

}  // namespace raykiln::server
