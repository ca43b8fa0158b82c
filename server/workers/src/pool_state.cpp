#include "pool_state.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <string>

namespace raykiln::server {
namespace {

render::PixelRect to_pixels(const TileRect& r) { return {r.x0, r.y0, r.x1, r.y1}; }

/// Border of one work item: what is thrown here ends this item and nothing else.
void render_parts(const TileTask& task, TileOutcome& outcome) try {
  for (const WorkItem::Part& part : task.item.parts) {
    outcome.results.push_back(render::render_tile(*task.scene, task.settings, to_pixels(part.rect),
                                                  task.blocks, task.stop));
    if (outcome.results.back().stopped) {
      outcome.stopped = true;
      return;
    }
  }
} catch (const std::exception& fault) {
  outcome.error = Error{ErrorKind::kInternal, "render_failed", fault.what(), ""};
} catch (...) {
  outcome.error = Error{ErrorKind::kInternal, "render_failed", "unknown fault", ""};
}

TileOutcome unstarted(const TileTask& task) {
  TileOutcome outcome;
  outcome.job = task.job;
  outcome.item = task.item;
  outcome.stopped = task.stop.stop_requested();
  return outcome;
}

}  // namespace

PoolState::PoolState(int threads, int niceness) : threads_(threads) {
  for (int i = 0; i < threads; ++i) {
    workers_.emplace_back([this, i, niceness] { work(i, niceness); });
  }
}

PoolState::~PoolState() { stop(); }

void PoolState::stop() {
  std::deque<Waiting> left;
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
    left.swap(waiting_);
  }
  wake_.notify_all();
  for (auto& worker : workers_) {
    if (worker.joinable()) worker.join();
  }
  for (Waiting& waiting : left) {
    TileOutcome outcome = unstarted(waiting.task);
    outcome.error = Error{ErrorKind::kUnavailable, "worker_stopped", "the workers are stopping", ""};
    waiting.done(std::move(outcome));
  }
}

void PoolState::start(TileTask task, std::function<void(TileOutcome)> done) {
  {
    const std::scoped_lock lock(mutex_);
    if (!stopping_) {
      waiting_.push_back({std::move(task), std::move(done)});
      done = nullptr;
    }
  }
  if (!done) {
    wake_.notify_one();
    return;
  }
  TileOutcome outcome = unstarted(task);
  outcome.error = Error{ErrorKind::kUnavailable, "worker_stopped", "the workers are stopping", ""};
  done(std::move(outcome));
}

void PoolState::run_tile(Waiting waiting, int worker, SteadyTime free_since) {
  TileOutcome outcome = unstarted(waiting.task);
  outcome.worker = worker;
  outcome.free_since = free_since;
  outcome.begun = std::chrono::steady_clock::now();
  if (!outcome.stopped) render_parts(waiting.task, outcome);
  outcome.ended = std::chrono::steady_clock::now();
  outcome.seconds = seconds_between(outcome.begun, outcome.ended);
  waiting.done(std::move(outcome));
}

/// Claims and runs one closure of a group that has some left. Called and left with the lock held.
void PoolState::run_one(Group& group, std::unique_lock<std::mutex>& lock) {
  const auto& closure = group.closures[group.next++];
  if (group.next == group.closures.size()) groups_.remove(&group);
  ++group.running;
  lock.unlock();
  std::exception_ptr fault;
  try {
    closure();
  } catch (...) {
    fault = std::current_exception();
  }
  lock.lock();
  if (fault && !group.fault) group.fault = fault;
  // Under the lock: the group dies as soon as its caller sees that nothing runs.
  if (--group.running == 0) group.ended.notify_all();
}

void PoolState::run_closures(std::span<const std::function<void()>> closures) {
  if (closures.empty()) return;
  Group group;
  group.closures = closures;
  std::unique_lock lock(mutex_);
  groups_.push_back(&group);
  if (closures.size() > 1) wake_.notify_all();
  while (group.next < group.closures.size()) run_one(group, lock);
  group.ended.wait(lock, [&] { return group.running == 0; });
  lock.unlock();
  if (group.fault) std::rethrow_exception(group.fault);
}

void PoolState::work(int worker, int niceness) {
  // Failures change nothing but how quick others are and what a debugger shows.
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), niceness);
  (void)::pthread_setname_np(::pthread_self(), ("render-" + std::to_string(worker)).c_str());
  SteadyTime free_since = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (true) {
    if (stopping_) return;
    if (!waiting_.empty()) {
      Waiting next = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      run_tile(std::move(next), worker, free_since);
      free_since = std::chrono::steady_clock::now();
      lock.lock();
    } else if (!groups_.empty()) {
      run_one(*groups_.front(), lock);
      free_since = std::chrono::steady_clock::now();
    } else {
      wake_.wait(lock);
    }
  }
}

}  // namespace raykiln::server
