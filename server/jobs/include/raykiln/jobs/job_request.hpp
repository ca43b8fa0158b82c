// What a user asks for, validated once against the limits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/light_model.hpp"

namespace raykiln::server {

/// `tile` of adaptive jobs: whoever reads a request from outside sets it.
inline constexpr int kAdaptiveTile = 16;

enum class PixelMode { kRandom, kCentre };
enum class DirectionSampling { kBsdf, kUniformSphere };
enum class Sampler { kRandom, kSobol };
enum class PixelFilter { kBox, kBlackmanHarris };
enum class EmitterChoice { kAuto, kPower, kTree };
enum class TextureFilter { kExact, kFootprint };

/// When a picture is done: whichever comes first.
struct StopRule {
  std::uint64_t samples = 64;        ///< a pixel
  std::optional<double> seconds{};   ///< wall time in `rendering`
  std::optional<double> error{};     ///< upper end of the 95 % interval of `error`; 0.02 is 2 %
  /// Samples a pixel of each tile, row by row: what a job that ended early needs to be made again.
  std::vector<std::uint64_t> tile_samples{};
};

/// `seconds` of a job that names an error alone, so that a target out of reach ends too.
inline constexpr double kDefaultErrorSeconds = 3600.0;

/// A camera of the user's own, world space in metres.
struct OwnCamera {
  std::array<double, 3> eye{};
  std::array<double, 3> look_at{};
  std::array<double, 3> up{0.0, 1.0, 0.0};
  double fov_deg = 40.0;  ///< full vertical angle
  std::optional<double> view_height{};  ///< makes it orthographic: height of what it sees, metres
};

/// A thin lens; radius 0 is a pinhole. Metres.
struct Lens {
  double radius = 0.0;
  double focus_distance = 1.0;  ///< along the line of sight
};

/// The whole picture of which the job renders a window, and where in it the window begins.
struct Crop {
  int x = 0, y = 0;
  int full_width = 1, full_height = 1;
};

/// What the tree of a scene may take. Where either stops the builder, rays take longer; no pixel changes.
struct TreeBudget {
  double references_per_triangle = 4.0;       ///< at most, 1 or more
  std::optional<std::uint64_t> max_bytes{};   ///< that building it may hold at once, beside the scene's mesh; unset: any
  bool operator==(const TreeBudget&) const = default;
};

/// Index into the cameras of the scene, name of one of them, or one of the user's own.
using CameraChoice = std::variant<int, std::string, OwnCamera>;

struct JobRequest {
  std::string name;             ///< free text for people; may be empty
  std::string scene;            ///< scene id: 64 hexadecimal digits
  CameraChoice camera = 0;
  std::optional<Lens> lens;     ///< in place of the camera's
  int width = 640, height = 480;
  std::optional<Crop> crop;     ///< unset: width x height is the whole picture
  StopRule stop;
  LightModel light_model = LightModel::kPhysical;
  LightModelOverrides light_model_overrides;
  std::optional<int> max_depth;  ///< reflections after the first hit; unset: see depth_limit()
  std::uint64_t seed = 0;
  int tile = 64;                ///< pixels a side
  int priority = 10;            ///< 1 .. 100: share of the workers relative to other jobs
  int branches = 1;             ///< rays shot from each hit; more than 1 is the seed's tree
  PixelMode pixel_mode = PixelMode::kRandom;
  PixelFilter filter = PixelFilter::kBox;
  DirectionSampling direction_sampling = DirectionSampling::kBsdf;
  bool emitter_sampling = true;
  EmitterChoice emitter_choice = EmitterChoice::kAuto;
  TextureFilter texture_filter = TextureFilter::kExact;
  Sampler sampler = Sampler::kRandom;
  /// "auto", "all" or "without=refraction,roulette": which effects are simulated. The names are the
  /// renderer's; whoever reads a request from outside checks them.
  std::string effects = "auto";
  /// "albedo,depth": layers that are made beside the picture, by the renderer's names and in its order.
  std::string layers{};
  /// Samples go where the error is, by cells of 16 x 16 pixels, which are the tiles then (kAdaptiveTile); needs
  /// an error or a time to stop at, and stop.samples is the most of any pixel.
  bool adaptive = false;
  TreeBudget tree{};
  bool reuse = false;           ///< a completed job whose picture is this one may stand in for it
};

/// What is wrong with so many references a triangle: "must be from 1 to 64"; nothing where they may be asked for.
[[nodiscard]] std::optional<std::string> references_error(double references_per_triangle, const JobLimits& limits);

/// Equal exactly for equal budgets: "4" or "4 1000000".
[[nodiscard]] std::string tree_budget_text(const TreeBudget& budget);

[[nodiscard]] std::string_view name(PixelMode value);
[[nodiscard]] std::string_view name(DirectionSampling value);
[[nodiscard]] std::string_view name(Sampler value);
[[nodiscard]] std::string_view name(PixelFilter value);
[[nodiscard]] std::string_view name(EmitterChoice value);
[[nodiscard]] std::string_view name(TextureFilter value);
[[nodiscard]] std::optional<PixelMode> pixel_mode_named(std::string_view name);
[[nodiscard]] std::optional<DirectionSampling> direction_sampling_named(std::string_view name);
[[nodiscard]] std::optional<Sampler> sampler_named(std::string_view name);
[[nodiscard]] std::optional<PixelFilter> filter_named(std::string_view name);
[[nodiscard]] std::optional<EmitterChoice> emitter_choice_named(std::string_view name);
[[nodiscard]] std::optional<TextureFilter> texture_filter_named(std::string_view name);

/// Reflections after the first hit at which paths end: as asked for, else 1024 where roulette ends
/// them before (one ray a hit), else 8.
[[nodiscard]] int depth_limit(const JobRequest& request);

/// The first thing that is wrong (code "invalid_request", `where` a JSON pointer such as
/// "/stop/samples"), or success. Whether scene and camera exist is the scheduler's to say.
[[nodiscard]] Status validate(const JobRequest& request, const JobLimits& limits);

/// Text that is equal exactly for equal requests: what an idempotency key is bound to.
[[nodiscard]] std::string request_digest(const JobRequest& request);

/// Text that is equal for requests that ask for the same picture of the same engine: `name`, `priority` and
/// `reuse` are left out, every other field counts.
[[nodiscard]] std::string result_digest(const JobRequest& request, std::string_view engine);

}  // namespace raykiln::server
