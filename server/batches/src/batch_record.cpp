#include <algorithm>

#include "raykiln/base/error_record.hpp"
#include "raykiln/base/wall_micros.hpp"
#include "raykiln/batches/batch.hpp"
#include "raykiln/jobs/request_record.hpp"

namespace raykiln::server {
namespace {

std::string encode_request(const JobRequest& request) {
  RecordWriter r;
  write_request(r, request);
  return r.str();
}

std::string encode_item_state(const BatchItem& item) {
  RecordWriter r;
  r.text("state", name(item.state));
  if (!item.job.empty()) r.text("job", item.job);
  if (item.reused) r.integer("reused", 1);
  r.integer("attempt", item.attempt);
  if (item.error) write_error(r, *item.error);
  return r.str();
}

bool decode_item_state(const std::string& text, BatchItem& item) {
  const auto r = RecordReader::parse(text);
  const auto state = r ? item_state_named(r->text("state")) : std::nullopt;
  if (!state) return false;
  item.state = *state;
  item.job = r->text("job");
  item.reused = r->integer("reused") != 0;
  item.attempt = static_cast<int>(std::clamp<std::int64_t>(r->integer("attempt", 1), 1, 1'000'000));
  item.error = read_error(*r);
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
  r.integer("created", to_micros(batch.created));
  for (const BatchItem& item : batch.items()) {
    r.text("item.name", item.name);
    r.text("item.request", encode_request(item.request));
  }
  return r.str();
}

std::string encode_batch_state(const Batch& batch) {
  RecordWriter r;
  r.natural("revision", batch.revision);
  if (batch.finished) r.integer("finished", to_micros(*batch.finished));
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
    const auto wanted = RecordReader::parse(requests[i]);
    if (!wanted) return std::nullopt;
    BatchItem item;
    item.name = names[i];
    item.request = read_request(*wanted);
    if (!decode_item_state(states[i], item)) return std::nullopt;
    whole.items.push_back(std::move(item));
  }
  Batch batch(asked->text("id"), asked->text("key"), std::move(whole), from_micros(asked->integer("created")));
  for (std::size_t i = 0; i < batch.items().size(); ++i) {
    if (std::exchange(batch.item(i).reused, false)) batch.mark_reused(i);
  }
  batch.revision = stands->natural("revision", 1);
  if (stands->has("finished") && batch.state() != BatchState::kRunning) batch.finished = from_micros(stands->integer("finished"));
  batch.cancelled = stands->integer("cancelled") != 0;
  return batch;
}

}  // namespace raykiln::server
