// The inside of the runner: everything happens on its thread, unless said otherwise.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "raykiln/base/serial_thread.hpp"
#include "raykiln/batches/batch_runner.hpp"

namespace raykiln::server {

class BatchWatcher final : public BatchSubscription {
 public:
  BatchWatcher(BatchPtr newest, std::function<void()> wake) : newest_(std::move(newest)), wake_(std::move(wake)) {}
  BatchPtr take() override {
    const std::scoped_lock lock(mutex_);
    return std::exchange(newest_, nullptr);
  }
  void tell(const BatchPtr& batch) {
    {
      const std::scoped_lock lock(mutex_);
      newest_ = batch;
    }
    wake_();
  }

 private:
  std::mutex mutex_;
  BatchPtr newest_;
  const std::function<void()> wake_;
};

/// Callbacks of the scheduler hold this object weakly and post.
class BatchRunner::Core : public std::enable_shared_from_this<Core> {
 public:
  Core(Parts parts, const BatchLimits& limits);

  bool post(std::function<void()> step);  ///< from any thread; false after stop()
  void stop() { thread_.stop(); }         ///< from the owner's thread

  // batch_core.cpp
  void restore();
  void submit(BatchRequest request, const std::string& key, const Reply<BatchPtr>& reply);
  void get(const BatchId& id, const Reply<BatchPtr>& reply);
  void list(const std::string& cursor, std::size_t limit, const Reply<BatchPage>& reply);
  void cancel(const BatchId& id, const Reply<BatchPtr>& reply);
  void rerun(const BatchId& id, const Reply<BatchPtr>& reply);
  void watch(const BatchId& id, std::function<void()> wake, const Reply<std::shared_ptr<BatchSubscription>>& reply);

 private:
  struct Live {
    explicit Live(Batch of) : batch(std::move(of)) {}
    Batch batch;
    std::uint64_t order = 0;                                    ///< of submission
    std::map<std::size_t, std::unique_ptr<Subscription>> jobs{};  ///< watched, by item
    std::map<std::size_t, std::uint64_t> asked{};               ///< items whose job is asked for; the revision then
    bool changed = false;                                       ///< since the last revision
    bool flush_planned = false;
    BatchPtr told{};                                            ///< the last revision, of a batch that runs
    bool unstored = false, store_planned = false;               ///< the store failed
    std::chrono::milliseconds store_again{};
  };
  using Step = std::function<void(Core&, Live&)>;
  /// Runs a step on the thread if runner and batch are still there; callable from any thread.
  using Later = std::function<void(Step)>;

  // batch_core.cpp
  [[nodiscard]] Live* find(const BatchId& id);
  [[nodiscard]] BatchPtr earlier(const std::string& key);
  [[nodiscard]] Result<std::vector<BatchId>> room_for(std::size_t items) const;
  Live& add(Batch batch);
  [[nodiscard]] static BatchPtr told(const Live& live);
  void changed(Live& live);
  void flush(Live& live);
  void store(Live& live);
  [[nodiscard]] Later later(const BatchId& id);

  // batch_items.cpp
  void pump();
  void end_if_done(Live& live);
  void start(Live& live, std::size_t index);
  void ask_for_job(Live& live, std::size_t index);
  void submitted(Live& live, std::size_t index, const Result<SubmittedJob>& answer);
  void watch_job(Live& live, std::size_t index);
  void watching(Live& live, std::size_t index, Result<std::unique_ptr<Subscription>>& answer);
  void look(Live& live, std::size_t index);
  void ended(Live& live, std::size_t index, const JobSnapshot& job);
  void cancel_job(const JobId& job);
  void rest_a_while();

  Parts parts_;
  const BatchLimits limits_;
  std::map<BatchId, std::unique_ptr<Live>> batches_;
  std::multimap<BatchId, std::weak_ptr<BatchWatcher>> watchers_;
  std::size_t active_ = 0;  ///< items, over all batches
  bool resting_ = false;    ///< the scheduler had no room
  std::uint64_t next_order_ = 1;
  SerialThread thread_;     ///< last: it uses what is above
};

}  // namespace raykiln::server
