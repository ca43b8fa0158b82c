#include <array>
#include <charconv>

#include "await.hpp"
#include "layer_picture.hpp"
#include "query.hpp"
#include "raykiln/api/api.hpp"
#include "raykiln/api/etag.hpp"
#include "raykiln/image/encode.hpp"
#include "raykiln/image/layers.hpp"
#include "raykiln/scheduler/layers.hpp"

namespace raykiln::server {
namespace {

constexpr double kMaxStops = 32.0;

/// What a client may ask of a picture.
struct ImageQuery {
  bool exr = false;
  bool half = false;  ///< values of the exr
  double exposure_stops = 0.0;
  std::string layer = "beauty";
};

std::variant<ImageQuery, Problem> parse_image_query(const Request& request) {
  if (auto problem = check_query(request, {"format", "type", "exposure", "rev", "layer"})) return *problem;
  ImageQuery query;
  if (const auto* format = find_value(request.query, "format")) {
    if (*format != "png" && *format != "exr") return invalid_parameter("format", "must be png or exr");
    query.exr = *format == "exr";
  }
  if (const auto* type = find_value(request.query, "type")) {
    if (*type != "float" && *type != "half") return invalid_parameter("type", "must be float or half");
    query.half = *type == "half";
    if (query.half && !query.exr) return invalid_parameter("type", "half is for format=exr");
  }
  const auto stops = query_number(request, "exposure", -kMaxStops, kMaxStops, 0.0);
  if (!stops) return invalid_parameter("exposure", "must be a number of stops from -32 to 32");
  // EXR holds radiance as it is: one copy serves all exposures.
  query.exposure_stops = query.exr || *stops == 0.0 ? 0.0 : *stops;
  if (!query_natural(request, "rev", 0, UINT64_MAX, 0)) {
    return invalid_parameter("rev", "must be a revision number");
  }
  if (const auto* layer = find_value(request.query, "layer")) query.layer = *layer;
  const LayerLook look = look_of(query.layer);
  if (look == LayerLook::kUnknown) return invalid_parameter("layer", "must be one of " + layer_choices());
  if (query.layer != "beauty" && query.half) {
    return invalid_parameter("type", "half is for layer=beauty: small errors would vanish");
  }
  if (look != LayerLook::kLight) query.exposure_stops = 0.0;
  return query;
}

std::string shortest(double value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string image_key(const JobImage& image, const ImageQuery& query) {
  return image.job + '-' + std::to_string(image.revision) + '-' + (query.half ? "half" : query.exr ? "exr" : "png") + '-' +
         shortest(query.exposure_stops) + '-' + query.layer;
}

std::map<std::string, std::string> exr_attributes(const JobImage& image, const std::string& version) {
  const EffectReport& effects = image.effects;  // without lines in jobs of older versions
  std::map<std::string, std::string> attributes{{"raykiln:scene", image.scene},
          {"raykiln:job", image.job},
          {"raykiln:revision", std::to_string(image.revision)},
          {"raykiln:light_model", light_model_label(image.request.light_model, image.request.light_model_overrides)},
          {"raykiln:seed", std::to_string(image.request.seed)},
          {"raykiln:sampler", std::string(name(image.request.sampler))},
          {"raykiln:adaptive", image.request.adaptive ? "true" : "false"},
          {"raykiln:samples", shortest(image.samples_per_pixel)},
          {"raykiln:max_depth", std::to_string(depth_limit(image.request))},
          {"raykiln:effects", effects.lines.empty() ? image.request.effects : effects.label},
          {"raykiln:simulated", simulated_names(effects)},
          {"raykiln:seconds", shortest(image.render_seconds)},
          {"raykiln:planes", "error: standard error of the mean, radiance, NaN where unknown; samples: per pixel; seconds: of workers, per pixel"},
          {"raykiln:version", version}};
  if (!image.request.layers.empty()) attributes["raykiln:layers"] = image.request.layers;
  return attributes;
}

std::variant<render::Bytes, render::EncodeError> encode_half(const JobImage& image, const std::string& version) {
  const auto range = render::half_range(image.image);
  auto attributes = exr_attributes(image, version);
  attributes["raykiln:clamped_values"] = std::to_string(range.clamped);
  attributes["raykiln:vanished_values"] = std::to_string(range.vanished);
  auto encoded = render::encode_half_exr(image.image, attributes);
  if (const auto* error = std::get_if<render::EncodeError>(&encoded)) return *error;
  return std::move(std::get<render::HalfExr>(encoded).bytes);
}

/// The planes of a layer's EXR. Seconds have a file of their own: they differ from run to run.
std::vector<render::ExtraPlane> planes_of(const JobImage& image, const std::string& layer) {
  if (layer == "seconds") return {{"seconds", image.seconds}};
  if (image.error.empty()) return {};
  std::vector<render::ExtraPlane> planes{{"error", image.error}, {"samples", image.samples}};
  for (const StoredLayer& of_job : image.layers) planes.push_back(exr_plane(of_job));
  return planes;
}

/// What every PNG says of itself; empty: nothing to say.
std::string note_of(const JobImage& image) {
  std::string note = approximation_note(image.effects);
  if (image.request.adaptive) note.append(note.empty() ? "" : "; ").append("adaptive sampling");
  return note;
}

Result<std::string> encode(const JobImage& image, const ImageQuery& query,
                           const std::string& version) {
  std::variant<render::Bytes, render::EncodeError> encoded;
  const std::string note = note_of(image);
  const auto effort = image.is_final ? render::PngEffort::kSmall : render::PngEffort::kQuick;
  if (query.half) {
    encoded = encode_half(image, version);
  } else if (query.exr) {
    encoded = render::encode_exr(image.image, exr_attributes(image, version), planes_of(image, query.layer));
  } else if (query.layer == "beauty") {
    encoded = render::encode_png(image.image, query.exposure_stops, note, effort);
  } else {
    encoded = render::encode_png(layer_picture(image, query.layer), query.exposure_stops, note, effort);
  }
  if (const auto* error = std::get_if<render::EncodeError>(&encoded)) {
    return Error{ErrorKind::kInternal, "internal", error->message, {}};
  }
  const auto& bytes = std::get<render::Bytes>(encoded);
  return std::string(bytes.begin(), bytes.end());
}

/// What the colours of a map stand for.
void tell_range(Response& response, const JobImage& image, const std::string& layer) {
  const auto range = layer_range(image, layer);
  response.headers.emplace_back("Raykiln-Low", shortest(range.low));
  response.headers.emplace_back("Raykiln-High", shortest(range.high));
  response.headers.emplace_back("Raykiln-Scale", std::string(name(range.scale)));
}

/// Of a job that was not asked for it, or of a picture that an older version has stored.
Response no_layer(const JobImage& image, const std::string& layer) {
  const auto asked = render::layer_set_of(image.request.layers).value_or(render::LayerSet());
  const auto known = render::layer_named(layer);
  if (known && !asked.contains(*known)) {
    return to_response(invalid_parameter(
        "layer", "the job does not make it: submit one with \"layers\": [\"" + layer + "\"]"));
  }
  return to_response(problem_of({ErrorKind::kNotFound, "image_not_ready", "there is no such layer of this picture", "layer", 1}));
}

}  // namespace

Answer Api::get_image(const Request& request) {
  if (auto problem = check_job_id(request)) return to_response(*problem);
  const auto parsed = parse_image_query(request);
  if (const auto* problem = std::get_if<Problem>(&parsed)) return to_response(*problem);
  const auto& query = std::get<ImageQuery>(parsed);

  const auto found = await<JobImagePtr>([&](auto reply) {
    const bool plain = query.layer == "beauty" && (!query.exr || query.half);
    parts_.scheduler.image(path_parameter(request, "job"), plain ? "beauty" : "all", std::move(reply));
  });
  if (!found) return to_response(problem_of(found.error()));
  const JobImage& image = **found;
  if (!has_layer(image, query.layer)) return no_layer(image, query.layer);
  const std::string key = image_key(image, query);
  Response response;
  response.headers = {{"ETag", '"' + key + '"'},
                      {"Raykiln-Revision", std::to_string(image.revision)},
                      {"Cache-Control", "no-cache"}};
  const auto* known = find_value(request.headers, "if-none-match");
  if (known != nullptr && etag_matches(*known, '"' + key + '"')) {
    response.status = 304;
    return response;
  }
  if (!query.exr && look_of(query.layer) == LayerLook::kMap) tell_range(response, image, query.layer);
  const auto bytes = images_.get(key, [&] {
    const auto begun = std::chrono::steady_clock::now();
    auto encoded = encode(image, query, config_.version);
    const double seconds = seconds_between(begun, std::chrono::steady_clock::now());
    parts_.metrics
        .histogram("raykiln_image_encode_seconds", "Encoding one picture",
                   {0.005, 0.02, 0.1, 0.5, 2, 10}, {{"format", query.exr ? "exr" : "png"}})
        .observe(seconds);
    return encoded;
  });
  if (!bytes) return to_response(problem_of(bytes.error()));
  response.content_type = query.exr ? "image/x-exr" : "image/png";
  response.headers.emplace_back("Content-Disposition", "inline; filename=\"" + image.job +
                                                           (query.exr ? ".exr\"" : ".png\""));
  if (query.half) {
    response.headers.emplace_back("Raykiln-Clamped-Values",
                                  std::to_string(render::half_range(image.image).clamped));
  }
  response.body = *bytes;
  return response;
}

}  // namespace raykiln::server
