#include "raykiln/jobs/job_request.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "raykiln/base/ids.hpp"
#include "raykiln/base/record.hpp"
#include "raykiln/base/sha256.hpp"
#include "raykiln/jobs/request_record.hpp"

namespace raykiln::server {
namespace {

/// Larger coordinates than this are no camera of any scene that the importer takes.
constexpr double kMaxCoordinate = 1e15;
constexpr double kLeastErrorTarget = 1e-4, kLargestErrorTarget = 1.0;

Error wrong(std::string where, std::string message) {
  return {ErrorKind::kInvalid, "invalid_request", std::move(message), std::move(where)};
}

template <class Number>
std::optional<Error> outside(const char* where, Number value, Number low, Number high) {
  if (value >= low && value <= high) return std::nullopt;
  return wrong(where, "must be from " + std::to_string(low) + " to " + std::to_string(high));
}

bool is_point(const std::array<double, 3>& p) {
  for (const double c : p) {
    if (!(std::abs(c) <= kMaxCoordinate)) return false;
  }
  return true;
}

std::array<double, 3> cross(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const std::array<double, 3>& a) { return std::hypot(a[0], a[1], a[2]); }

std::optional<Error> camera_error(const OwnCamera& camera) {
  if (!is_point(camera.eye)) return wrong("/camera/eye", "must be three finite numbers");
  if (!is_point(camera.look_at)) return wrong("/camera/look_at", "must be three finite numbers");
  if (!is_point(camera.up)) return wrong("/camera/up", "must be three finite numbers");
  if (camera.view_height && !(*camera.view_height > 0.0 && *camera.view_height <= kMaxCoordinate)) {
    return wrong("/camera/view_height", "must be a positive length");
  }
  if (!(camera.fov_deg > 0.0 && camera.fov_deg < 180.0)) {
    return wrong("/camera/fov_deg", "must be above 0 and below 180");
  }
  const std::array<double, 3> forward = {camera.look_at[0] - camera.eye[0],
                                         camera.look_at[1] - camera.eye[1],
                                         camera.look_at[2] - camera.eye[2]};
  if (!(length(forward) > 0.0)) return wrong("/camera/look_at", "must differ from eye");
  const double sine = length(cross(forward, camera.up)) / (length(forward) * length(camera.up));
  if (!(sine > 1e-6)) return wrong("/camera/up", "must not be zero or along the line of sight");
  return std::nullopt;
}

std::optional<Error> camera_error(const CameraChoice& choice) {
  if (const auto* index = std::get_if<int>(&choice)) {
    if (*index < 0) return wrong("/camera", "must not be negative");
  } else if (const auto* text = std::get_if<std::string>(&choice)) {
    if (text->empty() || text->size() > 200) return wrong("/camera", "must have 1 to 200 bytes");
  } else {
    return camera_error(std::get<OwnCamera>(choice));
  }
  return std::nullopt;
}

std::optional<Error> lens_error(const JobRequest& r) {
  if (!r.lens) return std::nullopt;
  if (!(r.lens->radius >= 0.0 && r.lens->radius <= kMaxCoordinate)) {
    return wrong("/lens/radius", "must be a length of 0 or more");
  }
  if (r.lens->focus_distance > 0.0 && r.lens->focus_distance <= kMaxCoordinate) return std::nullopt;
  return wrong("/lens/focus_distance", "must be a positive length");
}

std::optional<Error> crop_error(const JobRequest& r, const JobLimits& limits) {
  if (!r.crop) return std::nullopt;
  if (auto e = outside("/crop/full_width", r.crop->full_width, 1, limits.max_side)) return e;
  if (auto e = outside("/crop/full_height", r.crop->full_height, 1, limits.max_side)) return e;
  if (r.crop->x < 0 || r.width > r.crop->full_width - r.crop->x) {
    return wrong("/crop/x", "the window leaves the whole picture: x + width must be at most full_width");
  }
  if (r.crop->y < 0 || r.height > r.crop->full_height - r.crop->y) {
    return wrong("/crop/y", "the window leaves the whole picture: y + height must be at most full_height");
  }
  return std::nullopt;
}

std::optional<Error> filter_error(const JobRequest& r) {
  if (r.filter == PixelFilter::kBox || r.pixel_mode == PixelMode::kRandom) return std::nullopt;
  return wrong("/filter", "goes with pixel_mode random: in the centre there is nothing to filter");
}

std::optional<Error> tiles_error(const JobRequest& r, const JobLimits& limits) {
  const auto across = static_cast<std::uint64_t>((r.width + r.tile - 1) / r.tile);
  const auto down = static_cast<std::uint64_t>((r.height + r.tile - 1) / r.tile);
  if (across * down <= limits.max_tiles) return std::nullopt;
  return wrong("/tile", "would cut the picture into more than " +
                            std::to_string(limits.max_tiles) + " tiles");
}

std::optional<Error> stop_error(const JobRequest& r, const JobLimits& limits) {
  const StopRule& stop = r.stop;
  if (stop.seconds && !(*stop.seconds > 0.0 && *stop.seconds <= limits.max_seconds)) {
    return wrong("/stop/seconds", "must be above 0 and at most " +
                                      std::to_string(static_cast<long long>(limits.max_seconds)));
  }
  if (stop.error && !(*stop.error >= kLeastErrorTarget && *stop.error <= kLargestErrorTarget)) {
    return wrong("/stop/error", "must be from 0.0001 to 1");
  }
  if (r.adaptive && !stop.error && !stop.seconds) return wrong("/adaptive", "needs /stop/error or /stop/seconds");
  if (r.adaptive && r.tile != kAdaptiveTile) return wrong("/tile", "of an adaptive job must be 16");
  if (stop.tile_samples.empty()) return std::nullopt;
  if (stop.error || stop.seconds) {
    return wrong("/stop/tile_samples", "goes with neither seconds nor error");
  }
  const auto tiles = static_cast<std::size_t>((r.width + r.tile - 1) / r.tile) *
                     static_cast<std::size_t>((r.height + r.tile - 1) / r.tile);
  if (stop.tile_samples.size() != tiles) {
    return wrong("/stop/tile_samples", "must have one number a tile: " + std::to_string(tiles));
  }
  for (const std::uint64_t samples : stop.tile_samples) {
    if (samples > stop.samples) return wrong("/stop/tile_samples", "must not exceed /stop/samples");
  }
  if (*std::max_element(stop.tile_samples.begin(), stop.tile_samples.end()) == 0) {
    return wrong("/stop/tile_samples", "must not all be 0");
  }
  return std::nullopt;
}

std::optional<Error> branches_error(const JobRequest& r, const JobLimits& limits) {
  if (r.branches == 1) return std::nullopt;
  const double paths = std::pow(r.branches, depth_limit(r));
  if (paths <= static_cast<double>(limits.max_branch_paths)) return std::nullopt;
  return wrong("/branches", "branches to the power of max_depth must be at most " +
                                std::to_string(limits.max_branch_paths));
}

std::optional<Error> tree_error(const TreeBudget& tree, const JobLimits& limits) {
  if (auto why = references_error(tree.references_per_triangle, limits)) {
    return wrong("/tree/references_per_triangle", std::move(*why));
  }
  if (!tree.max_bytes) return std::nullopt;
  return outside<std::uint64_t>("/tree/max_bytes", *tree.max_bytes, 1, limits.max_tree_bytes);
}

bool has_control(const std::string& text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) return true;
  }
  return false;
}

std::optional<Error> name_error(const JobRequest& r, const JobLimits& limits) {
  if (r.name.size() > limits.max_name_bytes) {
    return wrong("/name", "must have at most " + std::to_string(limits.max_name_bytes) + " bytes");
  }
  if (has_control(r.name)) return wrong("/name", "must not hold control characters");
  return std::nullopt;
}

std::optional<Error> range_error(const JobRequest& r, const JobLimits& limits) {
  using std::uint64_t;
  if (auto e = outside("/width", r.width, 1, limits.max_side)) return e;
  if (auto e = outside("/height", r.height, 1, limits.max_side)) return e;
  if (auto e = outside<uint64_t>("/stop/samples", r.stop.samples, 1, limits.max_samples)) return e;
  if (auto e = outside("/max_depth", depth_limit(r), 0, limits.max_depth)) return e;
  if (auto e = outside("/branches", r.branches, 1, limits.max_branches)) return e;
  if (auto e = outside("/tile", r.tile, 1, limits.max_tile)) return e;
  return outside("/priority", r.priority, 1, limits.max_priority);
}

}  // namespace

std::string_view name(PixelMode value) {
  return value == PixelMode::kRandom ? "random" : "centre";
}
std::string_view name(DirectionSampling value) {
  return value == DirectionSampling::kBsdf ? "bsdf" : "uniform_sphere";
}

std::string_view name(Sampler value) { return value == Sampler::kRandom ? "random" : "sobol"; }

std::string_view name(PixelFilter value) {
  return value == PixelFilter::kBox ? "box" : "blackman_harris";
}

std::string_view name(EmitterChoice value) {
  switch (value) {
    case EmitterChoice::kPower: return "power";
    case EmitterChoice::kTree: return "tree";
    case EmitterChoice::kAuto: break;
  }
  return "auto";
}

std::string_view name(TextureFilter value) {
  return value == TextureFilter::kExact ? "exact" : "footprint";
}

std::optional<PixelMode> pixel_mode_named(std::string_view text) {
  if (text == "random") return PixelMode::kRandom;
  if (text == "centre") return PixelMode::kCentre;
  return std::nullopt;
}
std::optional<DirectionSampling> direction_sampling_named(std::string_view text) {
  if (text == "bsdf") return DirectionSampling::kBsdf;
  if (text == "uniform_sphere") return DirectionSampling::kUniformSphere;
  return std::nullopt;
}

std::optional<Sampler> sampler_named(std::string_view text) {
  if (text == "random") return Sampler::kRandom;
  if (text == "sobol") return Sampler::kSobol;
  return std::nullopt;
}

std::optional<PixelFilter> filter_named(std::string_view text) {
  for (const auto value : {PixelFilter::kBox, PixelFilter::kBlackmanHarris}) {
    if (name(value) == text) return value;
  }
  return std::nullopt;
}

std::optional<EmitterChoice> emitter_choice_named(std::string_view text) {
  for (const auto value : {EmitterChoice::kAuto, EmitterChoice::kPower, EmitterChoice::kTree}) {
    if (name(value) == text) return value;
  }
  return std::nullopt;
}

std::optional<TextureFilter> texture_filter_named(std::string_view text) {
  for (const auto value : {TextureFilter::kExact, TextureFilter::kFootprint}) {
    if (name(value) == text) return value;
  }
  return std::nullopt;
}

std::optional<std::string> references_error(double references_per_triangle, const JobLimits& limits) {
  if (references_per_triangle >= 1.0 && references_per_triangle <= limits.max_tree_references) return std::nullopt;
  return "must be from 1 to " + std::to_string(static_cast<long long>(limits.max_tree_references));
}

std::string tree_budget_text(const TreeBudget& budget) {
  char references[40];
  std::snprintf(references, sizeof references, "%.17g", budget.references_per_triangle);
  std::string text = references;
  if (budget.max_bytes) text.append(" ").append(std::to_string(*budget.max_bytes));
  return text;
}

int depth_limit(const JobRequest& request) {
  constexpr int kRouletteLimit = 1024, kFixedDepth = 8;
  if (request.max_depth) return *request.max_depth;
  const bool roulette = request.light_model_overrides.roulette.value_or(
      request.light_model == LightModel::kPhysical);
  return roulette && request.branches == 1 ? kRouletteLimit : kFixedDepth;
}

Status validate(const JobRequest& request, const JobLimits& limits) {
  if (!is_sha256_hex(request.scene)) {
    return wrong("/scene", "must be 64 lower-case hexadecimal digits");
  }
  if (auto e = name_error(request, limits)) return *e;
  if (auto e = camera_error(request.camera)) return *e;
  if (auto e = lens_error(request)) return *e;
  if (auto e = range_error(request, limits)) return *e;
  if (auto e = crop_error(request, limits)) return *e;
  if (auto e = filter_error(request)) return *e;
  if (auto e = tiles_error(request, limits)) return *e;
  if (auto e = stop_error(request, limits)) return *e;
  if (auto e = branches_error(request, limits)) return *e;
  if (auto e = tree_error(request.tree, limits)) return *e;
  return success();
}

std::string request_digest(const JobRequest& request) {
  RecordWriter record;
  write_request(record, request);
  return sha256_hex(record.str());
}

std::string result_digest(const JobRequest& request, std::string_view engine) {
  JobRequest picture = request;
  picture.name.clear();
  picture.priority = JobRequest{}.priority;
  picture.reuse = false;
  return sha256_hex(request_digest(picture).append("\n").append(engine));
}

}  // namespace raykiln::server
