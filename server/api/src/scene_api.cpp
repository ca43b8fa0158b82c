#include <algorithm>

#include "await.hpp"
#include "query.hpp"
#include "raykiln/api/api.hpp"
#include "raykiln/api/percent.hpp"
#include "raykiln/api/scene_json.hpp"
#include "scene_upload.hpp"

namespace raykiln::server {
namespace {

/// Handler threads are shared with everybody else: uploads may hold at most half of them.
constexpr int kMaxUploads = 4;
constexpr std::size_t kMaxNameBytes = 200;

std::variant<SceneKind, Problem> upload_kind(const Request& request) {
  const auto* type = find_value(request.headers, "content-type");
  const std::string text = type == nullptr ? std::string() : *type;
  if (text == "application/zip") return SceneKind::kZip;
  if (text == "model/gltf-binary") return SceneKind::kGlb;
  if (text.starts_with("multipart/form-data")) return SceneKind::kFiles;
  return Problem{415, "unsupported_media_type",
                 "a scene is application/zip, model/gltf-binary or multipart/form-data", "Content-Type"};
}

std::variant<std::string, Problem> scene_name(const Request& request) {
  std::optional<std::string> name;
  if (const auto* query = find_value(request.query, "name")) name = *query;
  else if (const auto* header = find_value(request.headers, "x-scene-name")) {
    name = percent_decode(*header);
    if (!name) return invalid_parameter("X-Scene-Name", "bad percent escape");
  }
  if (!name) return std::string();
  const bool has_control = std::any_of(name->begin(), name->end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
  });
  if (name->size() <= kMaxNameBytes && !has_control) return *name;
  return invalid_parameter("name", "at most 200 bytes without control characters");
}

std::variant<bool, Problem> allows_missing(const Request& request) {
  const auto* value = find_value(request.query, "allow_missing");
  if (value == nullptr || *value == "false") return false;
  if (*value == "true") return true;
  return invalid_parameter("allow_missing", "must be true or false");
}

}  // namespace

UploadStart Api::start_upload(const Request& request, std::string expected_digest) {
  if (auto problem = check_query(request, {"name", "allow_missing"})) return to_response(*problem);
  auto name = scene_name(request);
  if (const auto* problem = std::get_if<Problem>(&name)) return to_response(*problem);
  const auto missing = allows_missing(request);
  if (const auto* problem = std::get_if<Problem>(&missing)) return to_response(*problem);
  const auto kind = upload_kind(request);
  if (const auto* problem = std::get_if<Problem>(&kind)) return to_response(*problem);
  auto slot = UploadSlot::take(uploads_, kMaxUploads);
  if (!slot) {
    Problem problem{429, "too_many_uploads", "4 uploads are in progress"};
    problem.retry_after_s = 2;
    return to_response(problem);
  }
  const SceneKind chosen = std::get<SceneKind>(kind);
  auto staged = parts_.store.begin_upload(chosen);
  if (!staged) return to_response(problem_of(staged.error()));
  if (chosen != SceneKind::kFiles) {
    const auto begun = (*staged)->begin_file(chosen == SceneKind::kZip ? "scene.zip" : "scene.glb");
    if (!begun) return to_response(problem_of(begun.error()));
  }
  AddSceneOptions options{std::get<std::string>(std::move(name)), std::move(expected_digest),
                          std::get<bool>(missing)};
  return UploadPlan{std::make_unique<StagedUpload>(parts_.scheduler, std::move(slot),
                                                   std::move(staged).value(), std::move(options)),
                    chosen == SceneKind::kFiles, config_.uploads.max_upload_bytes};
}

UploadStart Api::create_scene(const Request& request) { return start_upload(request, {}); }

UploadStart Api::put_scene(const Request& request) {
  if (auto problem = check_scene_id(request)) return to_response(*problem);
  const std::string id = path_parameter(request, "scene");
  if (find_value(request.headers, "expect") != nullptr) {
    auto known = await<SceneView>([&](auto reply) { parts_.scheduler.scene(id, std::move(reply)); });
    if (known) {
      auto response = json_response(200, scene_json(*known));
      response.headers.emplace_back("Location", "/v1/scenes/" + id);
      return response;
    }
  }
  return start_upload(request, id);
}

Answer Api::list_scenes(const Request& request) {
  if (auto problem = check_query(request, {"limit", "cursor"})) return to_response(*problem);
  const auto limit = query_natural(request, "limit", 1, 200, 50);
  if (!limit) return to_response(invalid_parameter("limit", "must be an integer from 1 to 200"));
  const auto offset = query_natural(request, "cursor", 0, 1'000'000'000, 0);
  if (!offset) return to_response(invalid_parameter("cursor", "not a cursor of this server"));
  // One more than asked for tells whether there is a next page.
  auto scenes = await<std::vector<SceneView>>([&](auto reply) {
    parts_.scheduler.scenes(*offset, *limit + 1, std::move(reply));
  });
  if (!scenes) return to_response(problem_of(scenes.error()));
  std::string next;
  if (scenes->size() > *limit) {
    scenes->resize(*limit);
    next = std::to_string(*offset + *limit);
  }
  return json_response(200, scene_page_json(*scenes, next));
}

Answer Api::get_scene(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_scene_id(request)) return to_response(*problem);
  const auto scene = await<SceneView>([&](auto reply) {
    parts_.scheduler.scene(path_parameter(request, "scene"), std::move(reply));
  });
  if (!scene) return to_response(problem_of(scene.error()));
  return json_response(200, scene_json(*scene));
}

Answer Api::delete_scene(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_scene_id(request)) return to_response(*problem);
  const auto gone = await<std::monostate>([&](auto reply) {
    parts_.scheduler.delete_scene(path_parameter(request, "scene"), std::move(reply));
  });
  if (!gone) return to_response(problem_of(gone.error()));
  Response response;
  response.status = 204;
  return response;
}

Answer Api::prepare_scene(const Request& request) {
  if (auto problem = check_query(request, {})) return to_response(*problem);
  if (auto problem = check_scene_id(request)) return to_response(*problem);
  const std::string id = path_parameter(request, "scene");
  const auto scene = await<SceneView>([&](auto reply) {
    parts_.scheduler.prepare_scene(id, std::move(reply));
  });
  if (!scene) return to_response(problem_of(scene.error()));
  auto response = json_response(202, scene_json(*scene));
  response.headers.emplace_back("Location", "/v1/scenes/" + id);
  return response;
}

}  // namespace raykiln::server
