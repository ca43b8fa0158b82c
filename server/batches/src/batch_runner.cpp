#include "raykiln/batches/batch_runner.hpp"

#include "batch_core.hpp"

namespace raykiln::server {
namespace {

/// Runs `step(core, reply)` on the runner's thread; answers where there is none any more.
template <class T, class Core, class Step>
void ask(const std::shared_ptr<Core>& core, const Reply<T>& reply, Step step) {
  const bool posted = core->post([core = core.get(), reply, step = std::move(step)] {
    try {
      step(*core, reply);
    } catch (const std::bad_alloc&) {
      reply(Error{ErrorKind::kInternal, "internal", "out of memory", ""});
    }
  });
  if (!posted) reply(Error{ErrorKind::kUnavailable, "shutting_down", "the server is stopping", "", 5});
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
