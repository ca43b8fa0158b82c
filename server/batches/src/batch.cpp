#include "raykiln/batches/batch.hpp"

#include <algorithm>

#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

constexpr std::array<std::string_view, kItemStates> kNames{"waiting", "active", "completed", "failed", "cancelled", "skipped"};

}  // namespace

std::string_view name(ItemState state) { return kNames.at(static_cast<std::size_t>(state)); }

std::optional<ItemState> item_state_named(std::string_view text) {
  const auto found = std::find(kNames.begin(), kNames.end(), text);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<ItemState>(found - kNames.begin());
}

std::string_view name(BatchState state) {
  switch (state) {
    case BatchState::kCompleted: return "completed";
    case BatchState::kFailed: return "failed";
    case BatchState::kCancelled: return "cancelled";
    case BatchState::kRunning: break;
  }
  return "running";
}

Batch::Batch(BatchId batch_id, std::string key, BatchRequest asked, WallTime now)
    : id(std::move(batch_id)),
      idempotency_key(std::move(key)),
      created(now),
      request_(std::move(asked)),
      total_(request_.items.size()) {
  for (BatchItem& item : request_.items) {
    item.request.name = item.name;
    item.request.priority = request_.priority;
    item.request.reuse = request_.reuse;
    ++counts_[static_cast<std::size_t>(item.state)];
  }
}

BatchState Batch::state() const {
  if (count(ItemState::kWaiting) + count(ItemState::kActive) > 0) return BatchState::kRunning;
  if (count(ItemState::kFailed) > 0) return BatchState::kFailed;
  return count(ItemState::kCancelled) + count(ItemState::kSkipped) > 0 ? BatchState::kCancelled
                                                                       : BatchState::kCompleted;
}

void Batch::enter(std::size_t index, ItemState state) {
  BatchItem& changed = request_.items[index];
  --counts_[static_cast<std::size_t>(changed.state)];
  changed.state = state;
  ++counts_[static_cast<std::size_t>(state)];
  if (state == ItemState::kWaiting) first_waiting_ = std::min(first_waiting_, index);
}

void Batch::mark_reused(std::size_t index) {
  if (!std::exchange(request_.items[index].reused, true)) ++reused_;
}

std::optional<std::size_t> Batch::next_to_start() {
  const auto most = static_cast<std::size_t>(std::max(1, request_.max_active));
  if (count(ItemState::kActive) >= most || count(ItemState::kWaiting) == 0) return std::nullopt;
  while (request_.items[first_waiting_].state != ItemState::kWaiting) ++first_waiting_;
  return first_waiting_;
}

std::size_t Batch::skip_after_failure() {
  if (!request_.fail_fast || count(ItemState::kFailed) == 0) return 0;
  const std::size_t waiting = count(ItemState::kWaiting);
  for (std::size_t i = first_waiting_; i < items().size(); ++i) {
    if (items()[i].state == ItemState::kWaiting) enter(i, ItemState::kSkipped);
  }
  return waiting;
}

void Batch::cancel_waiting() {
  for (std::size_t i = first_waiting_; i < items().size(); ++i) {
    if (items()[i].state == ItemState::kWaiting) enter(i, ItemState::kCancelled);
  }
}

std::size_t Batch::rerun_failed() {
  std::size_t again = 0;
  for (std::size_t i = 0; i < items().size(); ++i) {
    BatchItem& one = item(i);
    const bool ended_badly = one.state == ItemState::kFailed || one.state == ItemState::kCancelled ||
                             one.state == ItemState::kSkipped;
    if (!ended_badly) continue;
    enter(i, ItemState::kWaiting);
    one.job.clear();
    one.error.reset();
    ++one.attempt;
    ++again;
  }
  return again;
}

Batch Batch::without_items() const {
  Batch summary(id, idempotency_key, {.name = request_.name, .priority = request_.priority, .max_active = request_.max_active,
                                      .fail_fast = request_.fail_fast, .reuse = request_.reuse}, created);
  summary.revision = revision;
  summary.finished = finished;
  summary.cancelled = cancelled;
  summary.total_ = total_;
  summary.reused_ = reused_;
  summary.counts_ = counts_;
  return summary;
}

std::string batch_digest(const BatchRequest& request) {
  std::string text = request.name + '\n' + std::to_string(request.priority) + ' ' + std::to_string(request.max_active) +
                     (request.fail_fast ? " f" : " -") + (request.reuse ? "r" : "-");
  for (const BatchItem& item : request.items) text += '\n' + item.name + ' ' + request_digest(item.request);
  return sha256_hex(text);
}

}  // namespace raykiln::server
