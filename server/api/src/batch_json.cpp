#include "raykiln/api/batch_json.hpp"

#include <nlohmann/json.hpp>

#include "problem_value.hpp"
#include "raykiln/api/job_json.hpp"

namespace raykiln::server {
namespace {

using nlohmann::json;
using Json = nlohmann::ordered_json;

std::string dump(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json item_value(const BatchItem& item) {
  return {{"name", item.name},
          {"state", name(item.state)},
          {"scene", item.request.scene},
          {"job", item.job.empty() ? Json(nullptr) : Json(item.job)},
          {"reused", item.reused},
          {"attempt", item.attempt},
          {"error", error_value(item.error)}};
}

Json summary_value(const Batch& batch) {
  Json counts = Json::object();
  for (const ItemState state : {ItemState::kWaiting, ItemState::kActive, ItemState::kCompleted, ItemState::kFailed,
                                ItemState::kCancelled, ItemState::kSkipped}) {
    counts[std::string(name(state))] = batch.count(state);
  }
  counts["reused"] = batch.reused();
  counts["total"] = batch.total();
  return {{"id", batch.id},
          {"name", batch.request().name},
          {"state", name(batch.state())},
          {"revision", batch.revision},
          {"created_at", rfc3339(batch.created)},
          {"finished_at", batch.finished ? Json(rfc3339(*batch.finished)) : Json(nullptr)},
          {"priority", batch.request().priority},
          {"max_active", batch.request().max_active},
          {"fail_fast", batch.request().fail_fast},
          {"reuse", batch.request().reuse},
          {"counts", std::move(counts)}};
}

}  // namespace

std::string batch_json(const Batch& batch) {
  Json whole = summary_value(batch), items = Json::array();
  for (const BatchItem& item : batch.items()) items.push_back(item_value(item));
  whole["items"] = std::move(items);
  return dump(whole);
}

std::string batch_page_json(const std::vector<Batch>& batches, const std::string& next_cursor) {
  Json list = Json::array();
  for (const Batch& batch : batches) list.push_back(summary_value(batch));
  return dump({{"batches", std::move(list)},
               {"next_cursor", next_cursor.empty() ? Json(nullptr) : Json(next_cursor)}});
}

std::optional<BatchView> parse_batch_view(std::string_view text) {
  try {
    const json value = json::parse(text.begin(), text.end());
    BatchView view;
    view.id = value.at("id").get<std::string>();
    view.state = value.at("state").get<std::string>();
    view.revision = value.at("revision").get<std::uint64_t>();
    for (const json& item : value.at("items")) {
      view.items.push_back({item.at("name").get<std::string>(), item.at("state").get<std::string>(),
                            item.at("job").is_string() ? item["job"].get<std::string>() : "",
                            item.at("reused").get<bool>(),
                            item.at("error").is_object() ? error_text(item["error"]) : ""});
    }
    return view;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

std::string scene_ids_json(const char* field, const std::vector<std::string>& ids) { return dump({{field, ids}}); }

std::optional<std::vector<std::string>> parse_missing_scenes(std::string_view text) {
  try {
    return json::parse(text.begin(), text.end()).at("missing").get<std::vector<std::string>>();
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace raykiln::server
