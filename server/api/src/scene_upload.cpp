#include "scene_upload.hpp"

#include "await.hpp"
#include "query.hpp"
#include "raykiln/api/problem.hpp"
#include "raykiln/api/scene_json.hpp"

namespace raykiln::server {
namespace {

std::optional<Response> refusal(const Status& status) {
  if (status) return std::nullopt;
  return to_response(problem_of(status.error()));
}

}  // namespace

std::unique_ptr<UploadSlot> UploadSlot::take(std::shared_ptr<std::atomic<int>> count, int most) {
  // Increment first, so that two who ask at once cannot both get the last one.
  if (count->fetch_add(1) >= most) {
    count->fetch_sub(1);
    return nullptr;
  }
  return std::unique_ptr<UploadSlot>(new UploadSlot(std::move(count)));
}

UploadSlot::~UploadSlot() { count_->fetch_sub(1); }

StagedUpload::StagedUpload(Scheduler& scheduler, std::unique_ptr<UploadSlot> slot,
                           std::unique_ptr<SceneUpload> staged, AddSceneOptions options)
    : scheduler_(scheduler),
      slot_(std::move(slot)),
      staged_(std::move(staged)),
      options_(std::move(options)) {}

std::optional<Response> StagedUpload::begin_file(const std::string& name) {
  return refusal(staged_->begin_file(name));
}

std::optional<Response> StagedUpload::write(std::span<const char> bytes) {
  return refusal(staged_->append(std::as_bytes(bytes)));
}

std::optional<Response> StagedUpload::end_file() { return std::nullopt; }

Response StagedUpload::finish() {
  if (auto refused = refusal(staged_->finish())) return *refused;
  const auto added = await<AddedScene>([&](auto reply) {
    scheduler_.add_scene(std::move(staged_), std::move(options_), std::move(reply));
  });
  if (!added) return to_response(problem_of(added.error()));
  auto response = json_response(added->created ? 201 : 200, scene_json(added->scene));
  response.headers.emplace_back("Location", "/v1/scenes/" + added->scene.record.id);
  return response;
}

}  // namespace raykiln::server
