#include "raykiln/api/batch_api.hpp"

#include <set>

#include "await.hpp"
#include "json_post.hpp"
#include "query.hpp"
#include "raykiln/api/batch_json.hpp"
#include "raykiln/base/ids.hpp"
#include "wake_relay.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kTextBytes = 8U << 20U, kTexts = 64;
constexpr int kMaxWriters = 2;

std::optional<Problem> check_batch_id(const Request& request) {
  if (is_plain_id(path_parameter(request, "batch"), 64)) return std::nullopt;
  return invalid_parameter("batch", "a batch id has 1 to 64 letters, digits, - or _");
}

Result<SharedBytes> text_of(EncodedCache& texts, const Batch& batch) {
  return texts.get(batch.id + ' ' + std::to_string(batch.revision), [&batch] { return batch_json(batch); });
}

Response batch_answer(int status, const Batch& batch, EncodedCache& texts) {
  auto text = text_of(texts, batch);
  if (!text) return to_response(problem_of(text.error()));
  auto response = json_response(status, std::move(*text));
  if (status == 202) response.headers.emplace_back("Location", "/v1/batches/" + batch.id);
  return response;
}

/// Calls `operation` of the runner with the id of the path.
template <class Operation>
Answer about_batch(const Request& request, int status, EncodedCache& texts, const Operation& operation) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_batch_id(request)) return to_response(*problem);
  const auto batch = await<BatchPtr>([&](auto reply) { operation(path_parameter(request, "batch"), std::move(reply)); });
  if (!batch) return to_response(problem_of(batch.error()));
  return batch_answer(status, **batch, texts);
}

class BatchFeed final : public EventFeed {
 public:
  BatchFeed(std::shared_ptr<WakeRelay> relay, std::shared_ptr<BatchSubscription> subscription,
            std::shared_ptr<EncodedCache> texts)
      : relay_(std::move(relay)), subscription_(std::move(subscription)), texts_(std::move(texts)) {}
  ~BatchFeed() override { relay_->disconnect(); }
  BatchFeed(const BatchFeed&) = delete;
  BatchFeed& operator=(const BatchFeed&) = delete;

  void start(std::function<void()> wake) override { relay_->connect(std::move(wake)); }
  [[nodiscard]] FeedStep poll() override {
    const BatchPtr batch = subscription_->take();
    if (!batch) return {};
    const auto text = text_of(*texts_, *batch);
    if (!text) return {.event = {}, .finished = true};  // no memory: the client connects again
    std::string event = "id: " + std::to_string(batch->revision) + "\nevent: batch\ndata: ";
    return {event.append(**text).append("\n\n"), batch->finished.has_value()};
  }

 private:
  std::shared_ptr<WakeRelay> relay_;
  std::shared_ptr<BatchSubscription> subscription_;
  std::shared_ptr<EncodedCache> texts_;
};

}  // namespace

BatchApi::BatchApi(const Config& config, BatchRunner& batches, Store& store)
    : limits_(config.jobs),
      batches_(batches),
      store_(store),
      texts_(std::make_shared<EncodedCache>(kTextBytes, kTexts, kMaxWriters)) {}

Answer BatchApi::create_batch(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_json_post(request)) return to_response(*problem);
  auto parsed = parse_batch_request(request.body, limits_);
  if (const auto* problem = std::get_if<Problem>(&parsed)) return to_response(*problem);
  const auto* key = find_value(request.headers, "idempotency-key");
  const auto batch = await<BatchPtr>([&](auto reply) {
    batches_.submit(std::get<BatchRequest>(std::move(parsed)), key != nullptr ? *key : "", std::move(reply));
  });
  if (!batch) return to_response(problem_of(batch.error()));
  return batch_answer(202, **batch, *texts_);
}

Answer BatchApi::list_batches(const Request& request) {
  if (auto problem = check_query(request, {"limit", "cursor"})) return to_response(*problem);
  const auto limit = query_natural(request, "limit", 1, 200, 50);
  if (!limit) return to_response(invalid_parameter("limit", "must be an integer from 1 to 200"));
  const auto page = await<BatchPage>([&](auto reply) {
    batches_.list(query_text(request, "cursor"), *limit, std::move(reply));
  });
  if (!page) return to_response(problem_of(page.error()));
  return json_response(200, batch_page_json(page->batches, page->next_cursor));
}

Answer BatchApi::get_batch(const Request& request) {
  return about_batch(request, 200, *texts_, [this](auto id, auto reply) { batches_.get(std::move(id), std::move(reply)); });
}
Answer BatchApi::cancel_batch(const Request& request) {
  return about_batch(request, 202, *texts_, [this](auto id, auto reply) { batches_.cancel(std::move(id), std::move(reply)); });
}
Answer BatchApi::rerun_batch(const Request& request) {
  return about_batch(request, 202, *texts_, [this](auto id, auto reply) { batches_.rerun(std::move(id), std::move(reply)); });
}

Answer BatchApi::watch_batch(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_batch_id(request)) return to_response(*problem);
  const std::string id = path_parameter(request, "batch");
  if (const auto* last = find_value(request.headers, "last-event-id")) {
    const auto batch = await<BatchPtr>([&](auto reply) { batches_.get(id, std::move(reply)); });
    if (batch && (*batch)->finished && *last == std::to_string((*batch)->revision)) {
      Response nothing_more;
      nothing_more.status = 204;
      return nothing_more;
    }
  }
  auto relay = std::make_shared<WakeRelay>();
  auto subscription = await<std::shared_ptr<BatchSubscription>>([&](auto reply) {
    batches_.watch(id, [relay] { relay->wake(); }, std::move(reply));
  });
  if (!subscription) return to_response(problem_of(subscription.error()));
  return std::make_unique<BatchFeed>(std::move(relay), std::move(subscription).value(), texts_);
}

Answer BatchApi::missing_scenes(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_json_post(request)) return to_response(*problem);
  const auto parsed = parse_scene_ids(request.body);
  if (const auto* problem = std::get_if<Problem>(&parsed)) return to_response(*problem);
  const auto& asked = std::get<std::vector<std::string>>(parsed);
  std::vector<std::string> missing;
  for (const std::string& id : std::set<std::string>(asked.begin(), asked.end())) {
    const auto scene = store_.scene(id);
    if (!scene && scene.error().kind != ErrorKind::kNotFound) return to_response(problem_of(scene.error()));
    if (!scene) missing.push_back(id);
  }
  return json_response(200, scene_ids_json("missing", missing));
}

}  // namespace raykiln::server
