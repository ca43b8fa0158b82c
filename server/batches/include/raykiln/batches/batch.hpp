// A batch: pictures that are rendered and reported together. Values and pure rules.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/job_request.hpp"
#include "raykiln/jobs/job_snapshot.hpp"

namespace raykiln::server {

using BatchId = std::string;

/// waiting -> active -> completed | failed | cancelled; waiting -> cancelled | skipped. An active item waits again
/// when there was no room for its job. Only a rerun leads from an end back to waiting.
enum class ItemState : std::uint8_t { kWaiting, kActive, kCompleted, kFailed, kCancelled, kSkipped };
inline constexpr std::size_t kItemStates = 6;
[[nodiscard]] std::string_view name(ItemState state);
[[nodiscard]] std::optional<ItemState> item_state_named(std::string_view name);

struct BatchItem {
  std::string name;      ///< unique in the batch
  JobRequest request;    ///< with the priority and reuse of the batch
  ItemState state = ItemState::kWaiting;
  JobId job{};           ///< of this attempt, or the one whose picture was reused
  bool reused = false;
  int attempt = 1;
  std::optional<Error> error{};  ///< when failed
};

struct BatchRequest {
  std::string name;
  int priority = 10;       ///< of all its jobs, and among batches
  int max_active = 4;      ///< jobs of this batch at once
  bool fail_fast = false;  ///< after a failure nothing more is started
  bool reuse = true;       ///< take the picture of an equal job that has completed
  std::vector<BatchItem> items{};  ///< waiting
};

inline constexpr std::size_t kMostItems = 1000;
inline constexpr int kMostActiveItems = 64;

/// running until no item waits or is active; then failed if one failed, cancelled if one was cancelled or
/// skipped, else completed. A rerun makes it running again.
enum class BatchState : std::uint8_t { kRunning, kCompleted, kFailed, kCancelled };
[[nodiscard]] std::string_view name(BatchState state);

class Batch {
 public:
  Batch(BatchId batch_id, std::string key, BatchRequest asked, WallTime now);

  BatchId id;
  std::string idempotency_key;
  std::uint64_t revision = 1;  ///< rises by one with every change that is told
  WallTime created{};
  std::optional<WallTime> finished{};
  bool cancelled = false;      ///< asked for; what was active then may still complete

  [[nodiscard]] const BatchRequest& request() const { return request_; }
  [[nodiscard]] const std::vector<BatchItem>& items() const { return request_.items; }
  [[nodiscard]] std::size_t total() const { return total_; }
  [[nodiscard]] std::size_t count(ItemState state) const { return counts_[static_cast<std::size_t>(state)]; }
  [[nodiscard]] std::size_t reused() const { return reused_; }
  [[nodiscard]] BatchState state() const;

  /// The item to change; its state changes by enter() alone.
  [[nodiscard]] BatchItem& item(std::size_t index) { return request_.items[index]; }
  void enter(std::size_t index, ItemState state);
  void mark_reused(std::size_t index);

  /// The item to start now, if one waits and fewer than max_active are active.
  [[nodiscard]] std::optional<std::size_t> next_to_start();
  /// What still waits after a failure is skipped under fail_fast. Their number.
  std::size_t skip_after_failure();
  /// Waiting items become cancelled.
  void cancel_waiting();
  /// Failed, cancelled and skipped items wait again, with a new attempt. Their number.
  std::size_t rerun_failed();
  /// All but the items, which may be many.
  [[nodiscard]] Batch without_items() const;

 private:
  BatchRequest request_;
  std::size_t total_ = 0, reused_ = 0;
  std::array<std::size_t, kItemStates> counts_{};
  std::size_t first_waiting_ = 0;  ///< none waits before it
};

/// Equal for equal batches: what an idempotency key is bound to.
[[nodiscard]] std::string batch_digest(const BatchRequest& request);

/// Two texts for the store: what was asked for, once, and how it stands, with every change.
[[nodiscard]] std::string encode_batch_request(const Batch& batch);
[[nodiscard]] std::string encode_batch_state(const Batch& batch);
/// Active items are so still: their jobs are found under their keys.
[[nodiscard]] std::optional<Batch> decode_batch(std::string_view request, std::string_view state);

}  // namespace raykiln::server
