// A matrix of scenes, cameras and settings, spread out into the requests of jobs.
#include <set>

#include "job_request_value.hpp"
#include "json_fields.hpp"
#include "raykiln/api/batch_json.hpp"
#include "raykiln/api/job_json.hpp"
#include "raykiln/api/picture_name.hpp"
#include "raykiln/base/ids.hpp"

namespace raykiln::server {
namespace {

using nlohmann::json;
using Errors = std::vector<FieldError>;
using Need = FieldReader::Need;

constexpr std::size_t kMostSettingsBytes = 4096;  ///< of one entry: it is copied into every picture

class Matrix {
 public:
  Matrix(const JobLimits& limits, Errors& errors, BatchRequest& batch) : limits_(limits), errors_(errors), batch_(batch) {}

  void read(FieldReader& reader) {
    defaults_ = json::object();
    if (const json* value = reader.any("defaults")) {
      if (is_settings(*value, "/defaults")) defaults_ = *value;
    }
    const json* scenes = reader.any("scenes", Need::kRequired);
    if (scenes == nullptr) return;
    if (!is_list(*scenes)) return reader.error("scenes", "invalid_value", list_rule());
    for (std::size_t i = 0; i < scenes->size() && go_on(); ++i) read_scene((*scenes)[i], "/scenes/" + std::to_string(i));
  }

 private:
  [[nodiscard]] bool go_on() const { return errors_.size() < kMaxFieldErrors && !full_; }
  void wrong(const std::string& pointer, const char* code, const std::string& detail) {
    if (errors_.size() < kMaxFieldErrors) errors_.push_back({pointer, code, detail});
  }
  static bool is_list(const json& value) { return value.is_array() && !value.empty() && value.size() <= kMostItems; }
  static std::string list_rule() { return "must be a list of 1 to " + std::to_string(kMostItems) + " entries"; }

  bool is_settings(const json& value, const std::string& pointer) {
    if (!value.is_object()) {
      wrong(pointer, "wrong_type", "must be an object with fields of a job");
      return false;
    }
    for (const char* key : {"scene", "priority", "reuse"}) {
      if (value.contains(key)) wrong(pointer + '/' + key, "unknown_field", "is no setting of a picture");
    }
    const auto stop = value.find("stop");
    if (stop != value.end() && stop->is_object() && stop->contains("tile_samples")) {
      wrong(pointer + "/stop/tile_samples", "unknown_field", "is for single jobs");
    }
    if (value.dump(-1, ' ', false, json::error_handler_t::replace).size() <= kMostSettingsBytes) return true;
    wrong(pointer, "out_of_range", "must have at most " + std::to_string(kMostSettingsBytes) + " bytes");
    return false;
  }

  void read_scene(const json& value, const std::string& pointer) {
    if (!value.is_object()) return wrong(pointer, "wrong_type", "must be an object with scene and name");
    FieldReader reader(value, pointer, errors_);
    const auto scene = reader.text("scene", {0, 100}, Need::kRequired);
    const auto label = reader.text("name", {1, kMostPictureName}, Need::kRequired);
    const json* cameras = reader.any("cameras");
    const json* settings = reader.any("settings");
    reader.finish();
    if (cameras != nullptr && !is_list(*cameras)) return wrong(pointer + "/cameras", "invalid_value", list_rule());
    if (settings != nullptr && !is_list(*settings)) return wrong(pointer + "/settings", "invalid_value", list_rule());
    if (!scene || !label) return;
    const json no_cameras = json::array({nullptr}), no_settings = json::array({json::object()});
    const json& each_camera = cameras != nullptr ? *cameras : no_cameras;
    const json& each_setting = settings != nullptr ? *settings : no_settings;
    for (std::size_t c = 0; c < each_camera.size() && go_on(); ++c) {
      for (std::size_t s = 0; s < each_setting.size() && go_on(); ++s) {
        const std::string at = settings != nullptr ? pointer + "/settings/" + std::to_string(s) : pointer;
        if (c == 0 && settings != nullptr && !is_settings(each_setting[s], at)) continue;
        if (!each_setting[s].is_object()) continue;
        add(*scene, *label, cameras != nullptr ? &each_camera[c] : nullptr, each_setting[s], at);
      }
    }
  }

  static std::string camera_label(const json* chosen) {
    if (chosen == nullptr) return {};
    const json& camera = *chosen;
    if (camera.is_string()) return camera.get<std::string>();
    if (camera.is_number_unsigned()) return std::to_string(camera.get<std::uint64_t>());
    if (!camera.is_object()) return {};
    const auto name = camera.find("name");
    return name != camera.end() && name->is_string() ? name->get<std::string>() : "camera";
  }

  void add(const std::string& scene, const std::string& label, const json* camera, const json& setting, const std::string& pointer) {
    if (batch_.items.size() >= kMostItems) {
      full_ = true;
      return wrong("/scenes", "out_of_range", "are more than " + std::to_string(kMostItems) + " pictures");
    }
    json whole = defaults_;
    whole.update(setting);
    const auto own_name = whole.find("name");
    const std::string setting_name = own_name != whole.end() && own_name->is_string() ? own_name->get<std::string>() : "";
    BatchItem item;
    item.name = picture_name(label, camera_label(camera), setting_name);
    if (item.name.size() > kMostPictureName) return wrong(pointer, "out_of_range", "makes a name that is too long");
    if (!names_.insert(item.name).second) {
      return wrong(pointer, "invalid_value", "two pictures are named \"" + item.name + '"');
    }
    if (camera != nullptr && !whole.contains("camera")) {
      json& own = whole["camera"] = *camera;
      if (own.is_object()) own.erase("name");
    }
    whole["scene"] = scene;
    whole["name"] = item.name;
    item.request = read_job_request(whole, pointer, limits_, errors_);
    batch_.items.push_back(std::move(item));
  }

  const JobLimits& limits_;
  Errors& errors_;
  BatchRequest& batch_;
  json defaults_;
  std::set<std::string> names_;
  bool full_ = false;
};

}  // namespace

std::variant<BatchRequest, Problem> parse_batch_request(std::string_view body, const JobLimits& limits) {
  return parse_object<BatchRequest>(body, [&](FieldReader& reader, Errors& errors, BatchRequest& batch) {
    if (const auto text = reader.text("name", {0, limits.max_name_bytes})) batch.name = *text;
    const auto most_priority = static_cast<std::uint64_t>(limits.max_priority);
    if (const auto n = reader.natural("priority", {1, most_priority})) batch.priority = static_cast<int>(*n);
    if (const auto n = reader.natural("max_active", {1, kMostActiveItems})) batch.max_active = static_cast<int>(*n);
    batch.fail_fast = reader.boolean("fail_fast").value_or(batch.fail_fast);
    batch.reuse = reader.boolean("reuse").value_or(batch.reuse);
    Matrix(limits, errors, batch).read(reader);
  });
}

std::string batch_request_json(const BatchRequest& batch) {
  nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
  for (const BatchItem& item : batch.items) {
    auto settings = job_request_value(item.request);
    for (const char* key : {"scene", "name", "priority", "reuse"}) settings.erase(key);
    scenes.push_back({{"scene", item.request.scene},
                      {"name", item.name},
                      {"settings", nlohmann::ordered_json::array({std::move(settings)})}});
  }
  const nlohmann::ordered_json whole{{"name", batch.name},           {"priority", batch.priority},
                                     {"max_active", batch.max_active}, {"fail_fast", batch.fail_fast},
                                     {"reuse", batch.reuse},         {"scenes", std::move(scenes)}};
  return whole.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::variant<std::vector<std::string>, Problem> parse_scene_ids(std::string_view body) {
  return parse_object<std::vector<std::string>>(body, [](FieldReader& reader, Errors&, std::vector<std::string>& ids) {
    const json* scenes = reader.any("scenes", Need::kRequired);
    if (scenes == nullptr) return;
    const bool listed = scenes->is_array() && scenes->size() <= kMostItems;
    for (std::size_t i = 0; listed && i < scenes->size(); ++i) {
      const json& id = (*scenes)[i];
      if (id.is_string() && is_sha256_hex(id.get_ref<const std::string&>())) ids.push_back(id.get<std::string>());
    }
    if (listed && ids.size() == scenes->size()) return;
    reader.error("scenes", "invalid_value", "must be a list of at most " + std::to_string(kMostItems) + " scene ids");
  });
}

}  // namespace raykiln::server
