#include "batch_scenes.hpp"

#include <chrono>
#include <thread>

#include "batch_judge.hpp"
#include "raykiln/api/batch_json.hpp"
#include "raykiln/api/scene_json.hpp"

namespace raykiln::server {
namespace {

constexpr int kTries = 60;  ///< at a server that is busy with other uploads, a second apart

}  // namespace

BatchScenes::BatchScenes(BatchResult& result) {
  std::map<std::filesystem::path, Result<std::string>> known;
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    const auto& path = result.plan.pictures[i].scene;
    auto found = known.find(path);
    if (found == known.end()) {
      auto package = find_scene_files(path);
      auto id = package ? scene_id(*package) : Result<std::string>(package.error());
      if (id) packages_.emplace(*id, std::move(*package));
      found = known.emplace(path, std::move(id)).first;
    }
    PictureResult& picture = result.pictures[i];
    if (found->second) {
      picture.scene = *found->second;
    } else {
      picture.state = PictureState::kFailed;
      picture.failure = failure_text(found->second.error());
    }
  }
}

bool BatchScenes::upload(Remote& remote) {
  if (packages_.empty()) return true;
  std::vector<std::string> ids;
  for (const auto& [id, package] : packages_) ids.push_back(id);
  const auto answer = remote.ask("POST", "/v1/missing-scenes", {{"Content-Type", "application/json"}},
                                 scene_ids_json("scenes", ids));
  if (!answer) return false;
  const auto missing = parse_missing_scenes(answer->body);
  if (!missing) {
    remote.fail(ExitCode::kFailure, "the server's answer is no list of scenes");
    return false;
  }
  for (const std::string& id : *missing) {
    if (packages_.contains(id) && !send(remote, id)) return false;
  }
  return true;
}

bool BatchScenes::send(Remote& remote, const std::string& id) {
  for (int tries = 1;; ++tries) {
    auto sent = put_scene(remote.address(), packages_.at(id), id);
    const bool busy = sent && (sent->status == 429 || sent->status == 503);
    if (busy && tries < kTries) {
      std::this_thread::sleep_for(std::chrono::seconds(1));
      continue;
    }
    // What is wrong with a scene is the matter of its pictures alone.
    const bool refused = sent && (sent->status == 400 || sent->status == 413 || sent->status == 415 || sent->status == 422);
    if (refused) refusals_[id] = problem_text(sent->body);
    return refused || remote.check(std::move(sent)).has_value();
  }
}

std::string BatchScenes::refusal(const std::string& scene) const {
  const auto found = refusals_.find(scene);
  return found == refusals_.end() ? "" : found->second;
}

}  // namespace raykiln::server
