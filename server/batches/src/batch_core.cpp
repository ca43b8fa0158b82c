// What clients ask about batches, and what the store knows of them.
#include "batch_core.hpp"

#include <algorithm>

#include "raykiln/base/ids.hpp"

namespace raykiln::server {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLongestStoreWait = std::chrono::minutes(1);

/// Changes that come closer together are one revision: a store is not flushed, and a thousand items are not
/// written out for all who watch, for each of them.
milliseconds flush_interval(const Batch& batch) {
  return milliseconds(50 + static_cast<std::int64_t>(batch.total()) / 5);
}

Error batch_not_found(const BatchId& id) { return {ErrorKind::kNotFound, "batch_not_found", "there is no such batch", id}; }

Error too_many_running() { return {ErrorKind::kTooMany, "queue_full", "too many batches are running", "", 10}; }

bool is_running(const Batch& batch) { return batch.state() == BatchState::kRunning; }

}  // namespace

BatchRunner::Core::Core(Parts parts, const BatchLimits& limits)
    : parts_(std::move(parts)), limits_(limits), thread_("batches") {}

bool BatchRunner::Core::post(std::function<void()> step) {
  return thread_.post([this, run = std::move(step)] {
    try {
      run();
    } catch (const std::exception& fault) {
      // The border of one step: the daemon outlives it.
      parts_.log.error("fault_of_a_batch", {{"why", fault.what()}});
    }
  });
}

void BatchRunner::Core::restore() {
  const auto records = parts_.records.all();
  if (!records) return parts_.log.error("batches_not_restored", {{"why", records.error().message}});
  for (const BatchRecord& record : *records) {
    auto batch = decode_batch(record.request, record.state);
    if (!batch) {
      parts_.log.warn("batch_record_dropped", {{"batch", record.id}});
      continue;
    }
    Live& live = add(std::move(*batch));
    // Their jobs go on, whatever becomes of what waits.
    for (std::size_t i = 0; i < live.batch.items().size(); ++i) {
      if (live.batch.items()[i].state == ItemState::kActive) ask_for_job(live, i);
    }
  }
  pump();
}

BatchRunner::Core::Live& BatchRunner::Core::add(Batch batch) {
  const BatchId id = batch.id;
  auto& live = batches_[id] = std::make_unique<Live>(std::move(batch));
  live->order = next_order_++;
  live->store_again = limits_.store_again;
  if (is_running(live->batch)) live->told = std::make_shared<const Batch>(live->batch);
  return *live;
}

BatchRunner::Core::Live* BatchRunner::Core::find(const BatchId& id) {
  const auto found = batches_.find(id);
  return found == batches_.end() ? nullptr : found->second.get();
}

BatchPtr BatchRunner::Core::earlier(const std::string& key) {
  for (const auto& [id, live] : batches_) {
    if (!key.empty() && live->batch.idempotency_key == key) return told(*live);
  }
  return nullptr;
}

/// The oldest batches that have ended and have to go; queue_full where that does not suffice.
Result<std::vector<BatchId>> BatchRunner::Core::room_for(std::size_t items) const {
  std::size_t running = 0, kept = items, count = batches_.size();
  std::vector<const Live*> ended;
  for (const auto& [id, live] : batches_) {
    kept += live->batch.total();
    if (is_running(live->batch)) ++running;
    else ended.push_back(live.get());
  }
  std::sort(ended.begin(), ended.end(), [](const Live* a, const Live* b) { return a->order > b->order; });
  std::vector<BatchId> leave;
  while ((count >= limits_.kept || kept > limits_.kept_items) && !ended.empty()) {
    leave.push_back(ended.back()->batch.id);
    kept -= ended.back()->batch.total();
    --count;
    ended.pop_back();
  }
  if (running < limits_.running && count < limits_.kept && kept <= limits_.kept_items) return leave;
  return too_many_running();
}

void BatchRunner::Core::submit(BatchRequest request, const std::string& key, const Reply<BatchPtr>& reply) {
  Batch batch(random_id("b_"), key, std::move(request), parts_.clock.wall());
  if (const BatchPtr known = earlier(key)) {
    if (batch_digest(known->request()) == batch_digest(batch.request())) return reply(known);
    return reply(Error{ErrorKind::kConflict, "idempotency_key_reused", "this key was used for another batch", "Idempotency-Key"});
  }
  const auto leave = room_for(batch.total());
  if (!leave) return reply(leave.error());
  auto stored = parts_.records.add({batch.id, encode_batch_request(batch), encode_batch_state(batch)}, *leave);
  if (!stored) return reply(stored.error());
  for (const BatchId& id : *leave) batches_.erase(id);
  parts_.log.info("batch_started", {{"batch", batch.id}, {"items", batch.total()}});
  reply(told(add(std::move(batch))));
  pump();
}

void BatchRunner::Core::get(const BatchId& id, const Reply<BatchPtr>& reply) {
  Live* live = find(id);
  if (live == nullptr) return reply(batch_not_found(id));
  reply(told(*live));
}

void BatchRunner::Core::list(const std::string& cursor, std::size_t limit, const Reply<BatchPage>& reply) {
  std::uint64_t before = next_order_;
  if (!cursor.empty()) {
    const Live* last = find(cursor);
    if (last == nullptr) return reply(Error{ErrorKind::kInvalid, "invalid_parameter", "not a cursor", "cursor"});
    before = last->order;
  }
  std::vector<Live*> sorted;
  for (const auto& [id, live] : batches_) {
    if (live->order < before) sorted.push_back(live.get());
  }
  std::sort(sorted.begin(), sorted.end(), [](const Live* a, const Live* b) { return a->order > b->order; });
  BatchPage page;
  if (sorted.size() > limit) {
    sorted.resize(limit);
    page.next_cursor = sorted.back()->batch.id;
  }
  for (Live* live : sorted) {
    page.batches.push_back((live->told ? *live->told : live->batch).without_items());
  }
  reply(std::move(page));
}

void BatchRunner::Core::cancel(const BatchId& id, const Reply<BatchPtr>& reply) {
  Live* live = find(id);
  if (live == nullptr) return reply(batch_not_found(id));
  if (is_running(live->batch)) {
    live->batch.cancelled = true;
    live->batch.cancel_waiting();
    for (const BatchItem& item : live->batch.items()) {
      if (item.state == ItemState::kActive && !item.job.empty()) cancel_job(item.job);
    }
    changed(*live);
    end_if_done(*live);
    flush(*live);
  }
  reply(told(*live));
  pump();
}

void BatchRunner::Core::rerun(const BatchId& id, const Reply<BatchPtr>& reply) {
  Live* live = find(id);
  if (live == nullptr) return reply(batch_not_found(id));
  if (is_running(live->batch)) {
    return reply(Error{ErrorKind::kConflict, "batch_running", "the batch has not ended", ""});
  }
  const auto running = std::count_if(batches_.begin(), batches_.end(), [](const auto& b) { return is_running(b.second->batch); });
  if (static_cast<std::size_t>(running) >= limits_.running) {
    return reply(too_many_running());
  }
  if (live->batch.rerun_failed() > 0) {
    live->batch.cancelled = false;
    live->batch.finished.reset();
    changed(*live);
    flush(*live);
  }
  reply(told(*live));
  pump();
}

void BatchRunner::Core::watch(const BatchId& id, std::function<void()> wake,
                              const Reply<std::shared_ptr<BatchSubscription>>& reply) {
  Live* live = find(id);
  if (live == nullptr) return reply(batch_not_found(id));
  std::erase_if(watchers_, [](const auto& entry) { return entry.second.expired(); });
  if (watchers_.size() >= limits_.watchers) {
    return reply(Error{ErrorKind::kUnavailable, "too_many_streams", "too many event streams are open", "", 5});
  }
  auto watcher = std::make_shared<BatchWatcher>(told(*live), std::move(wake));
  watchers_.emplace(id, watcher);
  reply(std::shared_ptr<BatchSubscription>(std::move(watcher)));
}

/// What was told last, which reads see too: they neither wait for the disk nor make it work.
BatchPtr BatchRunner::Core::told(const Live& live) {
  return live.told ? live.told : std::make_shared<const Batch>(live.batch);  // one that has ended: few ask
}

void BatchRunner::Core::changed(Live& live) {
  live.changed = true;
  if (std::exchange(live.flush_planned, true)) return;
  const auto step = [weak = weak_from_this(), id = live.batch.id] {
    const auto core = weak.lock();
    Live* late = core ? core->find(id) : nullptr;
    if (late == nullptr) return;
    late->flush_planned = false;
    core->flush(*late);
  };
  thread_.post_after(flush_interval(live.batch), [this, step] { post(step); });
}

/// One revision more: stored, then told.
void BatchRunner::Core::flush(Live& live) {
  if (!std::exchange(live.changed, false)) return;
  ++live.batch.revision;
  live.told = is_running(live.batch) ? std::make_shared<const Batch>(live.batch) : nullptr;
  store(live);
  const auto [first, last] = watchers_.equal_range(live.batch.id);
  const BatchPtr news = first != last ? told(live) : nullptr;
  for (auto at = first; at != last; ++at) {
    if (const auto watcher = at->second.lock()) watcher->tell(news);
  }
}

/// Should the store fail, the batch goes on, and what was told last is stored later: a process that dies before
/// asks the scheduler under the same keys.
void BatchRunner::Core::store(Live& live) {
  const Batch& newest = live.told ? *live.told : live.batch;
  const auto stored = parts_.records.set_state(newest.id, encode_batch_state(newest));
  live.unstored = !stored;
  if (stored) {
    live.store_again = limits_.store_again;
    return;
  }
  parts_.log.error("batch_not_stored", {{"batch", newest.id}, {"why", stored.error().message}});
  if (std::exchange(live.store_planned, true)) return;
  thread_.post_after(live.store_again, [go = later(newest.id)] {
    go([](Core& core, Live& there) {
      there.store_planned = false;
      if (there.unstored) core.store(there);
    });
  });
  live.store_again = std::min(2 * live.store_again, kLongestStoreWait);
}

BatchRunner::Core::Later BatchRunner::Core::later(const BatchId& id) {
  return [weak = weak_from_this(), id](Step step) {
    const auto self = weak.lock();
    if (!self) return;
    self->post([weak, id, step = std::move(step)] {
      const auto core = weak.lock();
      Live* live = core ? core->find(id) : nullptr;
      if (live != nullptr) step(*core, *live);
    });
  };
}

}  // namespace raykiln::server
