#include "raykiln/api/scene_json.hpp"

#include <nlohmann/json.hpp>

#include "effects_json.hpp"
#include "problem_value.hpp"
#include "raykiln/api/job_json.hpp"

namespace raykiln::server {
namespace {

using Json = nlohmann::ordered_json;

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json warnings_value(const SceneReport& report) {
  Json list = Json::array();
  for (const auto& warning : report.warnings) {
    list.push_back({{"code", warning.code},
                    {"message", warning.message},
                    {"where", warning.where},
                    {"count", warning.count}});
  }
  return list;
}

Json tree_value(const std::optional<TreeReport>& tree) {
  if (!tree) return nullptr;
  const auto& stats = tree->stats;
  return {{"build_seconds", tree->build_seconds}, {"nodes", stats.nodes},
          {"leaves", stats.leaves},               {"references", stats.references},
          {"sah_cost", stats.sah_cost},           {"bytes", stats.bytes},
          {"peak_bytes", stats.live_bytes_peak},  {"depth", stats.depth},
          {"budget_reached", stats.splits_over_budget > 0}};
}

Json prepare_value(const SceneView& scene) {
  if (scene.cache != CacheState::kBuilding) return nullptr;
  const auto stage = scene.prepare.stage == PrepareStage::kNone ? PrepareStage::kWaiting
                                                                : scene.prepare.stage;
  return {{"stage", name(stage)}, {"fraction", scene.prepare.fraction}};
}

Json scene_value(const SceneView& scene) {
  const SceneRecord& record = scene.record;
  const SceneReport& report = scene.report;
  Json cameras = Json::array();
  for (const auto& camera : report.cameras) {
    cameras.push_back({{"index", cameras.size()}, {"name", camera}});
  }
  return {{"id", record.id},
          {"name", record.name.empty() ? report.root_file : record.name},
          {"kind", name(record.kind)},
          {"format", report.format},
          {"root_file", report.root_file},
          {"bytes", record.bytes},
          {"files", record.files.size()},
          {"created_at", rfc3339(record.created)},
          {"triangles", report.triangles},
          {"dropped_triangles", report.dropped_triangles},
          {"materials", report.material_count},
          {"material_names", report.materials},
          {"objects", report.object_count},
          {"object_names", report.objects},
          {"lights",
           {{"point", report.point_lights},
            {"spot", report.spot_lights},
            {"directional", report.directional_lights},
            {"environment", report.environment},
            {"emitting_triangles", report.emissive_triangles}}},
          {"cameras", std::move(cameras)},
          {"bounds", {{"min", report.bounds_min}, {"max", report.bounds_max}}},
          {"effects", effect_report_value(report.effects)},
          {"warnings", warnings_value(report)},
          {"tree", tree_value(scene.tree)},
          {"cache", name(scene.cache)},
          {"prepare", prepare_value(scene)}};
}

SceneSummary summary_of(const Json& scene) {
  SceneSummary summary;
  summary.id = scene.at("id").get<std::string>();
  summary.name = scene.at("name").get<std::string>();
  summary.kind = scene.at("kind").get<std::string>();
  summary.cache = scene.at("cache").get<std::string>();
  summary.triangles = scene.at("triangles").get<std::uint64_t>();
  for (const Json& warning : scene.at("warnings")) {
    const auto where = warning.at("where").get<std::string>();
    const auto message = warning.at("message").get<std::string>();
    summary.warnings.push_back(where.empty() ? message : message + " (" + where + ')');
  }
  return summary;
}

}  // namespace

std::string scene_json(const SceneView& scene) { return dump(scene_value(scene)); }

std::string scene_page_json(const std::vector<SceneView>& scenes, const std::string& next_cursor) {
  Json list = Json::array();
  for (const auto& scene : scenes) list.push_back(scene_value(scene));
  return dump({{"scenes", std::move(list)},
               {"next_cursor", next_cursor.empty() ? Json(nullptr) : Json(next_cursor)}});
}

std::optional<SceneSummary> parse_scene(std::string_view text) {
  try {
    return summary_of(Json::parse(text.begin(), text.end()));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::optional<ScenePageView> parse_scene_page(std::string_view text) {
  try {
    const Json page = Json::parse(text.begin(), text.end());
    ScenePageView view;
    for (const Json& scene : page.at("scenes")) view.scenes.push_back(summary_of(scene));
    if (page.at("next_cursor").is_string()) view.next_cursor = page["next_cursor"].get<std::string>();
    return view;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string problem_text(std::string_view text) {
  try {
    const auto problem = nlohmann::json::parse(text.begin(), text.end());
    std::string out = error_text(problem);
    if (problem.contains("errors") && problem["errors"].size() > 1) {
      for (const auto& error : problem["errors"]) {
        out += "\n  " + error.at("pointer").get<std::string>() + ' ' + error.at("detail").get<std::string>();
      }
    }
    return out;
  } catch (const Json::exception&) {
    return std::string(text.substr(0, 400));
  }
}

}  // namespace raykiln::server
