#include "raykiln/batches/batch_runner.hpp"

#include "batch_core.hpp"

namespace raykiln::server {
namespace {

/// Runs `step(core, reply)` on the runner's thread.
template <class T, class Core, class Step>
void ask(const std::shared_ptr<Core>& core, const Reply<T>& reply, Step step) {
  answer_by([&core](auto run) { return core->post(std::move(run)); }, reply,
            [core = core.get(), step = std::move(step)](const Reply<T>& to) { step(*core, to); });
}

}  // namespace

BatchRunner::BatchRunner(Parts parts, const BatchLimits& limits)
    : core_(std::make_shared<Core>(std::move(parts), limits)) {
  core_->post([core = core_.get()] { core->restore(); });
}
BatchRunner::~BatchRunner() { stop(); }

void BatchRunner::submit(BatchRequest request, std::string key, Reply<BatchPtr> reply) {
  ask(core_, reply, [r = std::move(request), k = std::move(key)](Core& core, const auto& to) { core.submit(r, k, to); });
}
void BatchRunner::get(BatchId id, Reply<BatchPtr> reply) {
  ask(core_, reply, [id = std::move(id)](Core& core, const auto& to) { core.get(id, to); });
}
void BatchRunner::list(std::string cursor, std::size_t limit, Reply<BatchPage> reply) {
  ask(core_, reply, [c = std::move(cursor), limit](Core& core, const auto& to) { core.list(c, limit, to); });
}
void BatchRunner::cancel(BatchId id, Reply<BatchPtr> reply) {
  ask(core_, reply, [id = std::move(id)](Core& core, const auto& to) { core.cancel(id, to); });
}
void BatchRunner::rerun(BatchId id, Reply<BatchPtr> reply) {
  ask(core_, reply, [id = std::move(id)](Core& core, const auto& to) { core.rerun(id, to); });
}
void BatchRunner::watch(BatchId id, std::function<void()> wake, Reply<std::shared_ptr<BatchSubscription>> reply) {
  ask(core_, reply, [id = std::move(id), wake = std::move(wake)](Core& core, const auto& to) { core.watch(id, wake, to); });
}
void BatchRunner::stop() { core_->stop(); }

}  // namespace raykiln::server
