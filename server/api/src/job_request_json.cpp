#include <algorithm>
#include <array>

#include "effects_json.hpp"
#include "job_request_value.hpp"
#include "json_fields.hpp"
#include "raykiln/api/job_json.hpp"
#include "raykiln/base/ids.hpp"
#include "raykiln/image/layers.hpp"

namespace raykiln::server {
namespace {

using nlohmann::json;
using Need = FieldReader::Need;
using Errors = std::vector<FieldError>;

std::uint64_t as_bound(int limit) { return static_cast<std::uint64_t>(limit); }

/// A field that names one of a few values.
template <class Value>
void read_named(FieldReader& reader, const char* name, const char* choices,
                std::optional<Value> (*parse)(std::string_view), Value& target) {
  const auto text = reader.text(name, {0, 100});
  if (!text) return;
  if (const auto value = parse(*text)) target = *value;
  else reader.error(name, "invalid_value", std::string("must be one of ") + choices);
}

void read_integer(FieldReader& reader, const char* name, FieldReader::Bounds bounds, Need need,
                  int& target) {
  if (const auto value = reader.natural(name, bounds, need)) target = static_cast<int>(*value);
}

std::array<double, 3> as_array(const std::vector<double>& list) {
  return {list.at(0), list.at(1), list.at(2)};
}

std::optional<double> positive(FieldReader& reader, const char* name, double most) {
  const auto value = reader.number(name);
  if (!value || (*value > 0.0 && *value <= most)) return value;
  reader.error(name, "out_of_range", "must be above 0 and at most " + std::to_string(static_cast<long long>(most)));
  return std::nullopt;
}

OwnCamera read_own_camera(const json& object, std::string pointer, Errors& errors) {
  OwnCamera camera;
  FieldReader reader(object, std::move(pointer), errors);
  if (const auto eye = reader.numbers("eye", 3, Need::kRequired)) camera.eye = as_array(*eye);
  if (const auto at = reader.numbers("look_at", 3, Need::kRequired)) camera.look_at = as_array(*at);
  if (const auto up = reader.numbers("up", 3)) camera.up = as_array(*up);
  if (const auto fov = reader.number("fov_deg")) {
    camera.fov_deg = *fov;
    if (!(*fov > 0.0 && *fov < 180.0)) {
      reader.error("fov_deg", "out_of_range", "must lie between 0 and 180, both left out");
    }
  }
  camera.view_height = positive(reader, "view_height", 1e15);
  if (camera.view_height && object.contains("fov_deg")) {
    reader.error("view_height", "invalid_value", "excludes fov_deg: an orthographic camera has no angle");
  }
  reader.finish();
  return camera;
}

void read_camera(FieldReader& reader, Errors& errors, JobRequest& request) {
  const json* value = reader.any("camera");
  if (value == nullptr) return;
  if (value->is_object()) {
    request.camera = read_own_camera(*value, reader.pointer_to("camera"), errors);
  } else if (value->is_string()) {
    if (const auto name = reader.text("camera", {1, 200})) request.camera = *name;
  } else if (value->is_number()) {
    if (const auto index = reader.natural("camera", {0, 1'000'000})) {
      request.camera = static_cast<int>(*index);
    }
  } else {
    reader.error("camera", "wrong_type", "must be an index, a name or an object with eye and look_at");
  }
}

/// Whether there is one for each tile is validate()'s to say.
void read_tile_samples(FieldReader& reader, const json& list, const JobLimits& limits, StopRule& rule) {
  const bool fits = list.is_array() && list.size() <= limits.max_tiles &&
                    std::all_of(list.begin(), list.end(), [&](const json& n) {
                      return n.is_number_unsigned() && n.get<std::uint64_t>() <= limits.max_samples;
                    });
  if (!fits) return reader.error("tile_samples", "wrong_type", "must be a list of samples, one a tile");
  rule.tile_samples = list.get<std::vector<std::uint64_t>>();
}

/// Of a whole job, or of what is added to one, which has no samples of tiles.
enum class StopOf : bool { kJob, kExtension };

void read_stop(FieldReader& reader, const JobLimits& limits, Errors& errors, StopRule& rule, StopOf what) {
  const json* value = reader.any("stop", Need::kRequired);
  if (value == nullptr) return;
  if (!value->is_object()) {
    return reader.error("stop", "wrong_type", "must be an object such as {\"samples\": 64}");
  }
  FieldReader stop(*value, reader.pointer_to("stop"), errors);
  const auto samples = stop.natural("samples", {1, limits.max_samples});
  rule.seconds = positive(stop, "seconds", limits.max_seconds);
  rule.error = positive(stop, "error", 1.0);
  const auto* list = what == StopOf::kJob ? stop.any("tile_samples") : nullptr;
  if (list != nullptr) read_tile_samples(stop, *list, limits, rule);
  stop.finish();
  const bool other = value->contains("seconds") || value->contains("error") || list != nullptr;
  if (!samples && !other && !value->contains("samples")) {
    return reader.error("stop", "missing_field", "needs samples, seconds or error");
  }
  rule.samples = samples.value_or(limits.max_samples);
  if (!rule.tile_samples.empty() && !samples) {
    rule.samples = std::max<std::uint64_t>(
        1, *std::max_element(rule.tile_samples.begin(), rule.tile_samples.end()));
  }
  if (rule.error && !rule.seconds && !samples) rule.seconds = kDefaultErrorSeconds;
}

/// A switch of the light model that names one of two values.
template <class Value>
void read_switch(FieldReader& reader, const char* name, const char* choices,
                 std::optional<Value> (*parse)(std::string_view), std::optional<Value>& target) {
  const auto text = reader.text(name, {0, 100});
  if (!text) return;
  target = parse(*text);
  if (!target) reader.error(name, "invalid_value", std::string("must be one of ") + choices);
}

void read_overrides(FieldReader& reader, Errors& errors, JobRequest& request) {
  const json* value = reader.any("light_model_overrides");
  if (value == nullptr) return;
  if (!value->is_object()) {
    return reader.error("light_model_overrides", "wrong_type",
                        "must be an object such as {\"fresnel\": \"schlick\"}");
  }
  LightModelOverrides& o = request.light_model_overrides;
  FieldReader fields(*value, reader.pointer_to("light_model_overrides"), errors);
  read_switch(fields, "phong", "max, over_cos_o", phong_divisor_named, o.phong);
  read_switch(fields, "fresnel", "exact, schlick", fresnel_formula_named, o.fresnel);
  o.radiance_scaling = fields.boolean("radiance_scaling");
  read_switch(fields, "diffuse_sampling", "cosine, uniform", diffuse_sampling_named, o.diffuse_sampling);
  o.roulette = fields.boolean("roulette");
  fields.finish();
}

nlohmann::ordered_json overrides_value(const LightModelOverrides& o) {
  nlohmann::ordered_json value = nlohmann::ordered_json::object();
  if (o.phong) value["phong"] = name(*o.phong);
  if (o.fresnel) value["fresnel"] = name(*o.fresnel);
  if (o.radiance_scaling) value["radiance_scaling"] = *o.radiance_scaling;
  if (o.diffuse_sampling) value["diffuse_sampling"] = name(*o.diffuse_sampling);
  if (o.roulette) value["roulette"] = *o.roulette;
  return value;
}

void read_lens(FieldReader& reader, Errors& errors, JobRequest& request) {
  const json* value = reader.any("lens");
  if (value == nullptr) return;
  if (!value->is_object()) {
    return reader.error("lens", "wrong_type", "must be an object such as {\"radius\": 0.05, \"focus_distance\": 2}");
  }
  FieldReader fields(*value, reader.pointer_to("lens"), errors);
  Lens lens;
  lens.radius = fields.number("radius").value_or(0.0);
  if (!value->contains("radius")) fields.error("radius", "missing_field", "is needed: metres, 0 for a pinhole");
  if (!(lens.radius >= 0.0 && lens.radius <= 1e15)) {
    fields.error("radius", "out_of_range", "must be a length in metres, 0 or more");
  }
  const auto focus = positive(fields, "focus_distance", 1e15);
  if (focus) lens.focus_distance = *focus;
  else if (lens.radius > 0.0 && !value->contains("focus_distance")) {
    fields.error("focus_distance", "missing_field", "is needed where the radius is above 0");
  }
  fields.finish();
  request.lens = lens;
}

/// Whether the window lies within the whole picture is validate()'s to say.
void read_crop(FieldReader& reader, const JobLimits& limits, Errors& errors, JobRequest& request) {
  const json* value = reader.any("crop");
  if (value == nullptr) return;
  if (!value->is_object()) {
    return reader.error("crop", "wrong_type",
                        "must be an object such as {\"x\": 0, \"y\": 0, \"full_width\": 1920, \"full_height\": 1080}");
  }
  FieldReader fields(*value, reader.pointer_to("crop"), errors);
  const FieldReader::Bounds place{0, as_bound(limits.max_side)}, side{1, as_bound(limits.max_side)};
  Crop crop;
  read_integer(fields, "x", place, Need::kRequired, crop.x);
  read_integer(fields, "y", place, Need::kRequired, crop.y);
  read_integer(fields, "full_width", side, Need::kRequired, crop.full_width);
  read_integer(fields, "full_height", side, Need::kRequired, crop.full_height);
  fields.finish();
  request.crop = crop;
}

void read_tree(FieldReader& reader, const JobLimits& limits, Errors& errors, JobRequest& request) {
  const json* value = reader.any("tree");
  if (value == nullptr) return;
  if (!value->is_object()) {
    return reader.error("tree", "wrong_type",
                        "must be an object such as {\"references_per_triangle\": 8, \"max_bytes\": 500000000}");
  }
  FieldReader fields(*value, reader.pointer_to("tree"), errors);
  if (const auto references = fields.number("references_per_triangle")) {
    request.tree.references_per_triangle = *references;
    if (const auto why = references_error(*references, limits)) fields.error("references_per_triangle", "out_of_range", *why);
  }
  request.tree.max_bytes = fields.natural("max_bytes", {1, limits.max_tree_bytes});
  fields.finish();
}

nlohmann::ordered_json tree_value(const TreeBudget& tree) {
  nlohmann::ordered_json value{{"references_per_triangle", tree.references_per_triangle}};
  if (tree.max_bytes) value["max_bytes"] = *tree.max_bytes;
  return value;
}

/// The layers of the list, in the renderer's order; an error at each that is unknown or named before.
void read_layers(FieldReader& reader, Errors& errors, JobRequest& request) {
  const json* list = reader.any("layers");
  if (list == nullptr) return;
  if (!list->is_array() || list->size() > render::kLayers) {
    return reader.error("layers", "wrong_type", "must be a list of names out of " + render::all_layer_names());
  }
  render::LayerSet set;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const json& name = (*list)[i];
    const auto layer = name.is_string() ? render::layer_named(name.get<std::string>()) : std::nullopt;
    const bool twice = layer && set.contains(*layer);
    if (layer) set.insert(*layer);
    if ((layer && !twice) || errors.size() >= kMaxFieldErrors) continue;
    errors.push_back({reader.pointer_to("layers").append("/").append(std::to_string(i)), "invalid_value",
                      twice ? std::string("is named twice") : "must be one of " + render::all_layer_names()});
  }
  request.layers = render::layer_set_text(set);
}

std::vector<std::string> layer_names(const std::string& layers) {
  std::vector<std::string> names;
  for (const render::Layer layer : render::layers_in(render::layer_set_of(layers).value_or(render::LayerSet()))) {
    names.emplace_back(render::spec(layer).name);
  }
  return names;
}

/// All fields of a picture but when it is done.
void read_picture(FieldReader& reader, const JobLimits& limits, Errors& errors, JobRequest& request) {
  if (const auto scene = reader.text("scene", {0, 100}, Need::kRequired)) {
    request.scene = *scene;
    if (!is_sha256_hex(*scene)) {
      reader.error("scene", "invalid_value", "must be 64 lower-case hexadecimal digits");
    }
  }
  if (const auto name = reader.text("name", {0, limits.max_name_bytes})) request.name = *name;
  read_camera(reader, errors, request);
  read_lens(reader, errors, request);
  read_crop(reader, limits, errors, request);
  const FieldReader::Bounds side{1, as_bound(limits.max_side)};
  read_integer(reader, "width", side, Need::kRequired, request.width);
  read_integer(reader, "height", side, Need::kRequired, request.height);
  read_named(reader, "light_model", "physical, seed", light_model_named, request.light_model);
  read_overrides(reader, errors, request);
  if (const auto depth = reader.natural("max_depth", {0, as_bound(limits.max_depth)})) {
    request.max_depth = static_cast<int>(*depth);
  }
  read_integer(reader, "branches", {1, as_bound(limits.max_branches)}, Need::kOptional, request.branches);
  if (const auto seed = reader.natural("seed", {0, 9007199254740991U})) request.seed = *seed;
  read_named(reader, "pixel_mode", "random, centre", pixel_mode_named, request.pixel_mode);
  read_named(reader, "filter", "box, blackman_harris", filter_named, request.filter);
  read_named(reader, "direction_sampling", "bsdf, uniform_sphere", direction_sampling_named,
             request.direction_sampling);
  if (const auto on = reader.boolean("emitter_sampling")) request.emitter_sampling = *on;
  read_named(reader, "emitter_choice", "auto, power, tree", emitter_choice_named, request.emitter_choice);
  read_named(reader, "texture_filter", "exact, footprint", texture_filter_named, request.texture_filter);
  read_named(reader, "sampler", "random, sobol", sampler_named, request.sampler);
  read_effects(reader, errors, request);
  read_tree(reader, limits, errors, request);
  read_integer(reader, "tile", {1, as_bound(limits.max_tile)}, Need::kOptional, request.tile);
  read_integer(reader, "priority", {1, as_bound(limits.max_priority)}, Need::kOptional, request.priority);
}

void read_job(FieldReader& reader, const JobLimits& limits, Errors& errors, JobRequest& request) {
  read_picture(reader, limits, errors, request);
  read_stop(reader, limits, errors, request.stop, StopOf::kJob);
  read_layers(reader, errors, request);
  request.adaptive = reader.boolean("adaptive").value_or(false);
  if (request.adaptive) request.tile = kAdaptiveTile;
  request.reuse = reader.boolean("reuse").value_or(false);
}

}  // namespace

JobRequest read_job_request(const json& object, std::string pointer, const JobLimits& limits, Errors& errors) {
  JobRequest request;
  FieldReader reader(object, std::move(pointer), errors);
  read_job(reader, limits, errors, request);
  reader.finish();
  return request;
}

std::variant<JobRequest, Problem> parse_job_request(std::string_view body, const JobLimits& limits) {
  return parse_object<JobRequest>(body, [&](FieldReader& reader, Errors& errors, JobRequest& request) {
    read_job(reader, limits, errors, request);
  });
}

std::variant<Extension, Problem> parse_extension(std::string_view body, const JobLimits& limits) {
  return parse_object<Extension>(body, [&](FieldReader& reader, Errors& errors, Extension& extension) {
    read_stop(reader, limits, errors, extension.stop, StopOf::kExtension);
    if (const auto priority = reader.natural("priority", {1, as_bound(limits.max_priority)})) {
      extension.priority = static_cast<int>(*priority);
    }
  });
}

std::variant<JobRequest, Problem> parse_quote_request(std::string_view body, const JobLimits& limits) {
  return parse_object<JobRequest>(body, [&](FieldReader& reader, Errors& errors, JobRequest& request) {
    read_picture(reader, limits, errors, request);
    request.stop = {.samples = limits.max_samples,
                    .seconds = positive(reader, "pilot_seconds", kMostPilotSeconds).value_or(kPilotSeconds)};
  });
}

nlohmann::ordered_json stop_value(const StopRule& stop) {
  nlohmann::ordered_json value{{"samples", stop.samples}};
  if (stop.seconds) value["seconds"] = *stop.seconds;
  if (stop.error) value["error"] = *stop.error;
  if (!stop.tile_samples.empty()) value["tile_samples"] = stop.tile_samples;
  return value;
}

nlohmann::ordered_json job_request_value(const JobRequest& request) {
  nlohmann::ordered_json camera;
  if (const auto* index = std::get_if<int>(&request.camera)) camera = *index;
  else if (const auto* by_name = std::get_if<std::string>(&request.camera)) camera = *by_name;
  else {
    const auto& own = std::get<OwnCamera>(request.camera);
    camera = {{"eye", own.eye}, {"look_at", own.look_at}, {"up", own.up}};
    if (own.view_height) camera["view_height"] = *own.view_height;
    else camera["fov_deg"] = own.fov_deg;
  }
  nlohmann::ordered_json value{
          {"scene", request.scene},
          {"name", request.name},
          {"camera", std::move(camera)},
          {"width", request.width},
          {"height", request.height},
          {"stop", stop_value(request.stop)},
          {"light_model", name(request.light_model)},
          {"light_model_overrides", overrides_value(request.light_model_overrides)},
          {"max_depth", depth_limit(request)},
          {"branches", request.branches},
          {"seed", request.seed},
          {"pixel_mode", name(request.pixel_mode)},
          {"direction_sampling", name(request.direction_sampling)},
          {"filter", name(request.filter)},
          {"emitter_sampling", request.emitter_sampling},
          {"emitter_choice", name(request.emitter_choice)},
          {"texture_filter", name(request.texture_filter)},
          {"sampler", name(request.sampler)},
          {"effects", effects_value(request.effects)},
          {"layers", layer_names(request.layers)},
          {"tree", tree_value(request.tree)},
          {"tile", request.tile},
          {"priority", request.priority},
          {"adaptive", request.adaptive},
          {"reuse", request.reuse}};
  if (const auto& lens = request.lens) {
    value["lens"] = {{"radius", lens->radius}, {"focus_distance", lens->focus_distance}};
  }
  if (const auto& crop = request.crop) {
    value["crop"] = {{"x", crop->x}, {"y", crop->y}, {"full_width", crop->full_width}, {"full_height", crop->full_height}};
  }
  return value;
}

std::string job_request_json(const JobRequest& request) {
  return job_request_value(request).dump(-1, ' ', false,
                                         nlohmann::ordered_json::error_handler_t::replace);
}

std::string extension_json(const Extension& extension) {
  nlohmann::ordered_json value{{"stop", stop_value(extension.stop)}};
  if (extension.priority) value["priority"] = *extension.priority;
  return value.dump();
}

std::string quote_request_json(const JobRequest& request, double pilot_seconds) {
  auto value = job_request_value(request);
  value.erase("stop");
  value.erase("adaptive");
  value.erase("layers");
  value.erase("reuse");
  value["pilot_seconds"] = pilot_seconds;
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace raykiln::server
