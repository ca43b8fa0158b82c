#include <algorithm>
#include <chrono>

#include "raykiln/base/record.hpp"
#include "raykiln/batches/batch.hpp"

namespace raykiln::server {
namespace {

using std::chrono::microseconds;

std::int64_t micros(WallTime time) {
  return std::chrono::duration_cast<microseconds>(time.time_since_epoch()).count();
}
WallTime from_micros(std::int64_t value) {
  return WallTime(std::chrono::duration_cast<WallTime::duration>(microseconds(value)));
}

/// The text form of a request is that of a job's record.
std::string encode_request(const JobRequest& request) {
  JobSnapshot job;
  job.id = "item";
  job.request = request;
  return encode_job(job);
}

std::string encode_item_state(const BatchItem& item) {
  RecordWriter r;
  r.text("state", name(item.state));
  if (!item.job.empty()) r.text("job", item.job);
  if (item.reused) r.integer("reused", 1);
  r.integer("attempt", item.attempt);
  if (item.error) {
    r.integer("error.kind", static_cast<int>(item.error->kind));
    r.text("error.code", item.error->code);
    r.text("error.message", item.error->message);
    r.text("error.where", item.error->where);
  }
  return r.str();
}

bool decode_item_state(const std::string& text, BatchItem& item) {
  const auto r = RecordReader::parse(text);
  const auto state = r ? item_state_named(r->text("state")) : std::nullopt;
  if (!state) return false;
  item.state = *state == ItemState::kActive ? ItemState::kWaiting : *state;
  item.job = r->text("job");
  item.reused = r->integer("reused") != 0;
  item.attempt = static_cast<int>(std::clamp<std::int64_t>(r->integer("attempt", 1), 1, 1'000'000));
  if (r->has("error.code")) {
    const auto kind = std::clamp<std::int64_t>(r->integer("error.kind"), 0, static_cast<int>(ErrorKind::kInternal));
    item.error = Error{static_cast<ErrorKind>(kind), r->text("error.code"), r->text("error.message"),
                       r->text("error.where")};
  }
  return true;
}

BatchRequest decode_settings(const RecordReader& r) {
  BatchRequest request;
  request.name = r.text("name");
  request.priority = static_cast<int>(std::clamp<std::int64_t>(r.integer("priority", 10), 1, 100));
  request.max_active = static_cast<int>(std::clamp<std::int64_t>(r.integer("max_active", 1), 1, kMostActiveItems));
  request.fail_fast = r.integer("fail_fast") != 0;
  request.reuse = r.integer("reuse") != 0;
  return request;
}

}  // namespace

std::string encode_batch_request(const Batch& batch) {
  RecordWriter r;
  r.text("id", batch.id);
  r.text("key", batch.idempotency_key);
  r.text("name", batch.request().name);
  r.integer("priority", batch.request().priority);
  r.integer("max_active", batch.request().max_active);
  r.integer("fail_fast", batch.request().fail_fast ? 1 : 0);
  r.integer("reuse", batch.request().reuse ? 1 : 0);
  r.integer("created", micros(batch.created));
  for (const BatchItem& item : batch.items()) {
    r.text("item.name", item.name);
    r.text("item.request", encode_request(item.request));
  }
  return r.str();
}

std::string encode_batch_state(const Batch& batch) {
  RecordWriter r;
  r.natural("revision", batch.revision);
  if (batch.finished) r.integer("finished", micros(*batch.finished));
  if (batch.cancelled) r.integer("cancelled", 1);
  for (const BatchItem& item : batch.items()) r.text("item", encode_item_state(item));
  return r.str();
}

std::optional<Batch> decode_batch(std::string_view request, std::string_view state) {
  const auto asked = RecordReader::parse(request), stands = RecordReader::parse(state);
  if (!asked || !stands || asked->text("id").empty()) return std::nullopt;
  const auto& names = asked->list("item.name");
  const auto& requests = asked->list("item.request");
  const auto& states = stands->list("item");
  if (names.empty() || names.size() > kMostItems || names.size() != requests.size() || names.size() != states.size()) {
    return std::nullopt;
  }
  BatchRequest whole = decode_settings(*asked);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto job = decode_job(requests[i]);
    if (!job) return std::nullopt;
    BatchItem item;
    item.name = names[i];
    item.request = job->request;
    if (!decode_item_state(states[i], item)) return std::nullopt;
    whole.items.push_back(std::move(item));
  }
  Batch batch(asked->text("id"), asked->text("key"), std::move(whole), from_micros(asked->integer("created")));
  for (std::size_t i = 0; i < batch.items().size(); ++i) {
    if (std::exchange(batch.item(i).reused, false)) batch.mark_reused(i);
  }
  batch.revision = stands->natural("revision", 1);
  if (stands->has("finished")) batch.finished = from_micros(stands->integer("finished"));
  batch.cancelled = stands->integer("cancelled") != 0;
  return batch;
}

}  // namespace raykiln::server
