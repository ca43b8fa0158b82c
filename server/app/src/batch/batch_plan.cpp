#include "batch_plan.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "../input_file.hpp"
#include "raykiln/api/job_json.hpp"
#include "raykiln/api/picture_name.hpp"
#include "raykiln/batches/batch.hpp"

namespace raykiln::server {
namespace {

/// Stands for the id of a scene whose files have not been read.
const std::string kNoScene(64, '0');

/// Thrown and caught in this file alone: a file is read whole or not at all.
struct Wrong {
  Error error;
};
[[noreturn]] void wrong(const Value& at, const std::string& why) {
  throw Wrong{{ErrorKind::kInvalid, "invalid_file", why, at.line > 0 ? "line " + std::to_string(at.line) : ""}};
}

void only(const Value& map, const std::string& what, std::initializer_list<std::string_view> known) {
  if (map.kind != Value::Kind::kMap) wrong(map, what + " must be a map of fields");
  for (const auto& [key, value] : map.map) {
    if (std::find(known.begin(), known.end(), key) == known.end()) wrong(value, what + " has no field \"" + key + '"');
  }
}

double number(const Value& map, std::string_view key, double low, double high, double fallback) {
  const Value* value = map.find(key);
  if (value == nullptr) return fallback;
  double result = 0.0;
  const auto* end = value->text.data() + value->text.size();
  const auto [stop, error] = std::from_chars(value->text.data(), end, result);
  if (!value->is_text() || error != std::errc{} || stop != end || !(result >= low && result <= high)) {
    std::string why(key);
    wrong(*value, why.append(" must be a number from ").append(std::to_string(low)).append(" to ").append(std::to_string(high)));
  }
  return result;
}

int integer(const Value& map, std::string_view key, int low, int high, int fallback) {
  const double value = number(map, key, low, high, fallback);
  if (value != std::floor(value)) wrong(*map.find(key), std::string(key) + " must be an integer");
  return static_cast<int>(value);
}

bool flag(const Value& map, std::string_view key, bool fallback) {
  const Value* value = map.find(key);
  if (value == nullptr) return fallback;
  if (value->text != "true" && value->text != "false") wrong(*value, std::string(key) + " must be true or false");
  return value->text == "true";
}

std::string text(const Value& map, std::string_view key, const std::string& fallback) {
  const Value* value = map.find(key);
  if (value == nullptr) return fallback;
  if (!value->is_text() || value->text.empty()) wrong(*value, std::string(key) + " must be text");
  return value->text;
}

constexpr std::size_t kMostPatternBytes = 4096;   ///< as long as a path may be
constexpr std::size_t kMostSettingsBytes = 4096;  ///< of one picture, as JSON

const std::vector<Value>& list(const Value& map, std::string_view key) {
  static const std::vector<Value> kNone;
  const Value* value = map.find(key);
  if (value == nullptr) return kNone;
  if (value->kind != Value::Kind::kList || value->list.empty()) wrong(*value, std::string(key) + " must be a list");
  return value->list;
}

std::string camera_label(const Value& camera) {
  if (camera.is_text()) return camera.text;
  return text(camera, "name", "camera");
}

Value plain(std::string text) {
  Value value = text_value(std::move(text));
  value.quoted = false;
  return value;
}

/// A camera of one's own may have a name, which the job's request does not know.
Value camera_request(Value camera) {
  std::erase_if(camera.map, [](const auto& entry) { return entry.first == "name"; });
  return camera;
}

std::string filled(std::string pattern, const std::vector<std::pair<std::string, std::string>>& words) {
  for (const auto& [word, value] : words) {
    for (std::size_t at = pattern.find(word); at != std::string::npos; at = pattern.find(word, at + value.size())) {
      pattern.replace(at, word.size(), value);
    }
  }
  return pattern;
}

class Planner {
 public:
  Planner(const Value& file, std::filesystem::path folder, const JobLimits& limits)
      : file_(file), folder_(std::move(folder)), limits_(limits) {}

  BatchPlan plan() {
    only(file_, "the batch", {"name", "priority", "max_active", "reuse", "fail_fast", "false_alarms", "tolerance",
                              "thresholds", "defaults", "reference", "scenes"});
    plan_.name = text(file_, "name", "batch");
    if (plan_.name.size() > limits_.max_name_bytes) {
      wrong(file_, "name must have at most " + std::to_string(limits_.max_name_bytes) + " bytes");
    }
    plan_.priority = integer(file_, "priority", 1, limits_.max_priority, plan_.priority);
    plan_.max_active = integer(file_, "max_active", 1, kMostActiveItems, plan_.max_active);
    plan_.reuse = flag(file_, "reuse", plan_.reuse);
    plan_.fail_fast = flag(file_, "fail_fast", false);
    read_comparison();
    const auto& scenes = list(file_, "scenes");
    if (scenes.empty()) wrong(file_, "scenes is missing");
    for (const Value& scene : scenes) add_scene(scene);
    share_false_alarms();
    return std::move(plan_);
  }

 private:
  void read_comparison() {
    plan_.false_alarms = number(file_, "false_alarms", 1e-9, 0.5, plan_.false_alarms);
    plan_.comparison.noise.tolerance = number(file_, "tolerance", 0.0, 1.0, 0.0);
    const Value* thresholds = file_.find("thresholds");
    if (thresholds == nullptr) return;
    only(*thresholds, "thresholds", {"absolute", "relative", "failing_share", "hard_limit", "always"});
    auto& limits = plan_.comparison.thresholds;
    limits.absolute = number(*thresholds, "absolute", 0.0, 1e300, limits.absolute);
    limits.relative = number(*thresholds, "relative", 0.0, 1e300, limits.relative);
    limits.failing_share = number(*thresholds, "failing_share", 0.0, 1.0, limits.failing_share);
    limits.hard_limit = number(*thresholds, "hard_limit", 0.0, 1e300, limits.hard_limit);
    plan_.comparison.use_thresholds = flag(*thresholds, "always", false);
  }

  /// Bonferroni: no more alarms over the batch than one picture alone would be allowed.
  void share_false_alarms() {
    const auto compared = std::count_if(plan_.pictures.begin(), plan_.pictures.end(),
                                        [](const PlannedPicture& p) { return !p.reference.empty(); });
    plan_.comparison.noise.false_alarms = plan_.false_alarms / static_cast<double>(std::max<std::ptrdiff_t>(1, compared));
  }

  void add_scene(const Value& scene) {
    only(scene, "a scene", {"scene", "name", "cameras", "settings", "reference"});
    const std::string path = text(scene, "scene", "");
    if (path.empty()) wrong(scene, "scene is missing: the path of a scene");
    const auto whole = (folder_ / path).lexically_normal();
    const auto leaf = whole.filename().empty() ? whole.parent_path() : whole;
    const std::string label = text(scene, "name", leaf.stem().string());
    Value no_fields;
    no_fields.kind = Value::Kind::kMap;
    const std::vector<Value> first_camera{plain("0")}, no_settings{no_fields};
    const auto& cameras = list(scene, "cameras").empty() ? first_camera : list(scene, "cameras");
    const auto& settings = list(scene, "settings").empty() ? no_settings : list(scene, "settings");
    for (const Value& camera : cameras) {
      for (const Value& setting : settings) {
        if (setting.kind != Value::Kind::kMap) wrong(setting, "settings must be a list of maps");
        const std::string camera_name = scene.find("cameras") != nullptr ? camera_label(camera) : "";
        add_picture(scene, whole, label, camera, camera_name, setting);
      }
    }
  }

  void add_picture(const Value& scene, const std::filesystem::path& path, const std::string& label,
                   const Value& camera, const std::string& camera_name, const Value& setting) {
    const std::string setting_name = text(setting, "name", "");
    const std::string name = picture_name(label, camera_name, setting_name);
    // Files are named after pictures, with endings of their own.
    for (const char* ending : {".reference", ".difference", ".z"}) {
      if (name.ends_with(ending)) wrong(scene, "the name \"" + name + "\" may not end in " + ending);
    }
    if (name.size() > kMostPictureName) {
      wrong(scene, "the name of a picture is longer than " + std::to_string(kMostPictureName));
    }
    if (!names_.insert(name).second) {
      wrong(scene, "two pictures are named \"" + name + "\": give scenes or settings a name of their own");
    }
    if (plan_.pictures.size() >= kMostItems) wrong(scene, "more than " + std::to_string(kMostItems) + " pictures");
    PlannedPicture picture{.name = name, .scene = path, .reference = {}, .request = request(name, camera, setting)};
    const std::string pattern = text(scene, "reference", text(file_, "reference", ""));
    if (pattern.size() > kMostPatternBytes) wrong(scene, "reference is longer than " + std::to_string(kMostPatternBytes));
    if (!pattern.empty()) {
      picture.reference = (folder_ / filled(pattern, {{"{name}", name},
                                                      {"{scene}", file_name_text(label)},
                                                      {"{camera}", file_name_text(camera_name)},
                                                      {"{setting}", file_name_text(setting_name)}}))
                              .lexically_normal();
    }
    plan_.pictures.push_back(std::move(picture));
  }

  /// Defaults, then the setting, in the fields of POST /v1/jobs, read by what reads those.
  JobRequest request(const std::string& name, const Value& camera, const Value& setting) {
    Value whole;
    whole.kind = Value::Kind::kMap;
    if (const Value* defaults = file_.find("defaults")) {
      if (defaults->kind != Value::Kind::kMap) wrong(*defaults, "defaults must be a map of fields");
      whole = *defaults;
    }
    if (to_json(whole).size() + to_json(setting).size() > kMostSettingsBytes) {
      wrong(setting, "the settings of a picture must have at most " + std::to_string(kMostSettingsBytes) + " bytes");
    }
    for (const auto& [key, value] : setting.map) {
      if (key != "name") whole.set(key, value);
    }
    for (const char* key : {"scene", "name", "priority", "reuse"}) {
      if (whole.find(key) != nullptr) wrong(*whole.find(key), std::string(key) + " is no setting of a picture");
    }
    for (const auto& [key, text] : {std::pair{"width", "640"}, {"height", "480"}}) {
      if (whole.find(key) == nullptr) whole.set(key, plain(text));
    }
    if (whole.find("stop") == nullptr) {
      Value stop;
      stop.set("samples", plain("64"));
      whole.set("stop", stop);
    }
    if (whole.find("camera") == nullptr) whole.set("camera", camera_request(camera));
    whole.set("scene", text_value(kNoScene));
    whole.set("name", text_value(name));
    auto parsed = parse_job_request(to_json(whole), limits_);
    if (auto* problem = std::get_if<Problem>(&parsed)) {
      std::string why = "\"" + name + "\": " + problem->detail;
      for (const auto& field : problem->errors) why += "; " + field.pointer + ' ' + field.detail;
      wrong(setting, why);
    }
    return std::get<JobRequest>(std::move(parsed));
  }

  const Value& file_;
  std::filesystem::path folder_;
  const JobLimits& limits_;
  BatchPlan plan_;
  std::set<std::string> names_;
};

}  // namespace

Result<BatchPlan> plan_batch(const Value& file, const std::filesystem::path& folder, const JobLimits& limits) {
  try {
    return Planner(file, folder, limits).plan();
  } catch (const Wrong& wrong) {
    return wrong.error;
  }
}

Result<BatchPlan> read_batch_file(const std::filesystem::path& path, const JobLimits& limits) {
  const auto bytes = read_whole_file(path, std::uint64_t{1} << 20U);
  if (!bytes) return bytes.error();
  const auto value = parse_yaml({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (!value) return value.error();
  return plan_batch(*value, path.parent_path(), limits);
}

}  // namespace raykiln::server
