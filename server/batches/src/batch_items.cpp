// From a waiting item to its end.
#include <algorithm>

#include "batch_core.hpp"

namespace raykiln::server {
namespace {

constexpr auto kRest = std::chrono::milliseconds(250);

bool is_temporary(const Error& error) {
  return error.kind == ErrorKind::kTooMany || error.kind == ErrorKind::kUnavailable;
}

}  // namespace

/// Starts what there is room for: batches of higher priority first, older ones before younger ones.
void BatchRunner::Core::pump() {
  std::vector<Live*> running;
  for (const auto& [id, live] : batches_) {
    if (!live->batch.finished) running.push_back(live.get());
  }
  std::sort(running.begin(), running.end(), [](const Live* a, const Live* b) {
    const int more = a->batch.request().priority, less = b->batch.request().priority;
    return more != less ? more > less : a->order < b->order;
  });
  for (Live* live : running) {
    if (live->batch.skip_after_failure() > 0) changed(*live);
    while (!resting_ && active_ < limits_.jobs) {
      const auto next = live->batch.next_to_start();
      if (!next) break;
      start(*live, *next);
    }
    end_if_done(*live);
  }
}

void BatchRunner::Core::end_if_done(Live& live) {
  if (live.batch.state() == BatchState::kRunning || live.batch.finished) return;
  live.batch.finished = parts_.clock.wall();
  parts_.log.info("batch_ended", {{"batch", live.batch.id}, {"state", name(live.batch.state())}});
  changed(live);
  flush(live);
}

/// Told when the scheduler has answered: a full queue moves nothing.
void BatchRunner::Core::start(Live& live, std::size_t index) {
  live.batch.enter(index, ItemState::kActive);
  ask_for_job(live, index);
}

/// Of an active item.
void BatchRunner::Core::ask_for_job(Live& live, std::size_t index) {
  const BatchItem& item = live.batch.items()[index];
  ++active_;
  live.asked[index] = live.batch.revision;
  // The same key after a restart gives the same job. No client can send one with blanks.
  const std::string key = "batch " + live.batch.id + ' ' + std::to_string(index) + ' ' + std::to_string(item.attempt);
  parts_.scheduler.submit({item.request, key}, [go = later(live.batch.id), index](Result<SubmittedJob> answer) {
    go([index, answer = std::move(answer)](Core& core, Live& there) { core.submitted(there, index, answer); });
  });
}

void BatchRunner::Core::submitted(Live& live, std::size_t index, const Result<SubmittedJob>& answer) {
  const auto asked = live.asked.extract(index);
  if (answer) {
    changed(live);
    live.batch.item(index).job = answer->job.id;
    if (answer->reused) live.batch.mark_reused(index);
    if (is_final(answer->job.state)) return ended(live, index, answer->job);
    if (live.batch.cancelled) cancel_job(answer->job.id);
    return watch_job(live, index);
  }
  --active_;
  if (live.batch.cancelled) {
    live.batch.enter(index, ItemState::kCancelled);
    changed(live);
  } else if (is_temporary(answer.error())) {
    live.batch.enter(index, ItemState::kWaiting);
    if (asked.mapped() != live.batch.revision) changed(live);  // it was told as active meanwhile
    rest_a_while();
  } else {
    live.batch.item(index).error = answer.error();
    live.batch.enter(index, ItemState::kFailed);
    changed(live);
  }
  pump();
}

/// The queue belongs to others too: one look a quarter of a second.
void BatchRunner::Core::rest_a_while() {
  if (std::exchange(resting_, true)) return;
  thread_.post_after(kRest, [this] {
    post([this] {
      resting_ = false;
      pump();
    });
  });
}

void BatchRunner::Core::watch_job(Live& live, std::size_t index) {
  const Later go = later(live.batch.id);
  const auto wake = [go, index] { go([index](Core& core, Live& there) { core.look(there, index); }); };
  parts_.scheduler.watch(live.batch.items()[index].job, wake, [go, index](Result<std::unique_ptr<Subscription>> answer) {
    // Steps are copied, a subscription is not.
    auto held = std::make_shared<Result<std::unique_ptr<Subscription>>>(std::move(answer));
    go([index, held](Core& core, Live& there) { core.watching(there, index, *held); });
  }, Seat::kServer);
}

void BatchRunner::Core::watching(Live& live, std::size_t index, Result<std::unique_ptr<Subscription>>& answer) {
  if (live.batch.items()[index].state != ItemState::kActive) return;
  if (answer) {
    live.jobs[index] = std::move(answer).value();
    return look(live, index);
  }
  if (!is_temporary(answer.error())) {
    live.batch.item(index).error = answer.error();
    live.batch.enter(index, ItemState::kFailed);
    --active_;
    changed(live);
    return pump();
  }
  const auto again = [index](Core& core, Live& there) {
    if (there.batch.items()[index].state == ItemState::kActive) core.watch_job(there, index);
  };
  thread_.post_after(kRest, [go = later(live.batch.id), again] { go(again); });
}

void BatchRunner::Core::look(Live& live, std::size_t index) {
  const auto watched = live.jobs.find(index);
  if (watched == live.jobs.end()) return;
  // Two may be there: the one at the start, and the newest.
  SnapshotPtr job = watched->second->take();
  while (job && !is_final(job->state)) job = watched->second->take();
  if (!job) return;
  live.jobs.erase(watched);
  if (live.batch.items()[index].state == ItemState::kActive) ended(live, index, *job);
}

void BatchRunner::Core::ended(Live& live, std::size_t index, const JobSnapshot& job) {
  --active_;
  switch (job.state) {
    case JobState::kCompleted: live.batch.enter(index, ItemState::kCompleted); break;
    case JobState::kCancelled: live.batch.enter(index, ItemState::kCancelled); break;
    default: live.batch.enter(index, ItemState::kFailed);
  }
  live.batch.item(index).error = job.error;
  changed(live);
  pump();
}

void BatchRunner::Core::cancel_job(const JobId& job) {
  parts_.scheduler.cancel(job, [](const Result<JobSnapshot>&) {});  // its last state tells
}

}  // namespace raykiln::server
