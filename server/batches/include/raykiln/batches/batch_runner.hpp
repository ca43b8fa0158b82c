// Runs batches on top of the scheduler's jobs.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/base/reply.hpp"
#include "raykiln/batches/batch.hpp"
#include "raykiln/scheduler/scheduler.hpp"
#include "raykiln/store/batch_records.hpp"

namespace raykiln::server {

/// An immutable picture of a batch at one revision.
using BatchPtr = std::shared_ptr<const Batch>;

/// One watcher's end: take() gives the newest batch if it is newer than the last one taken, else null.
class BatchSubscription {
 public:
  virtual ~BatchSubscription() = default;
  [[nodiscard]] virtual BatchPtr take() = 0;
};

struct BatchLimits {
  std::size_t running = 64;        ///< batches that have not ended
  std::size_t kept = 256;          ///< batches in all; the oldest that have ended go first
  std::size_t kept_items = 50'000;
  std::size_t jobs = 64;           ///< of all batches in the scheduler at once
  std::size_t watchers = 64;       ///< of all batches
  std::chrono::milliseconds store_again{1000};  ///< after the store failed; twice as long each time, to a minute
};

struct BatchPage {
  std::vector<Batch> batches;  ///< newest first, without their items
  std::string next_cursor;     ///< empty: no more
};

/// Safe to use from any thread; replies come once, on the runner's thread, and must only post (see Scheduler).
/// Errors: batch_not_found, idempotency_key_reused, queue_full (too many batches), too_many_streams,
/// batch_running (rerun of one that has not ended), invalid_parameter (cursor), shutting_down.
class BatchRunner {
 public:
  struct Parts {
    Scheduler& scheduler;
    BatchRecords& records;
    const Clock& clock;
    Log log;
  };
  /// Goes on with what had not ended.
  explicit BatchRunner(Parts parts, const BatchLimits& limits = {});
  ~BatchRunner();  ///< stop(). To be destroyed before the scheduler.
  BatchRunner(const BatchRunner&) = delete;
  BatchRunner& operator=(const BatchRunner&) = delete;

  /// An equal batch that was submitted under this key before is the answer, whatever has become of it.
  void submit(BatchRequest request, std::string idempotency_key, Reply<BatchPtr> reply);
  void get(BatchId id, Reply<BatchPtr> reply);
  void list(std::string cursor, std::size_t limit, Reply<BatchPage> reply);
  /// Waiting items end at once, active jobs are cancelled. A batch that has ended stays as it is.
  void cancel(BatchId id, Reply<BatchPtr> reply);
  /// What failed, was cancelled or skipped waits again.
  void rerun(BatchId id, Reply<BatchPtr> reply);
  /// `wake` must only post.
  void watch(BatchId id, std::function<void()> wake, Reply<std::shared_ptr<BatchSubscription>> reply);
  /// Starts nothing more, and hears nothing more: the next process goes on.
  void stop();

 private:
  class Core;
  std::shared_ptr<Core> core_;
};

}  // namespace raykiln::server
