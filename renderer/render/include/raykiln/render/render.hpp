// The public door of the renderer: prepare a scene once, render tiles of it, fold them into a film.
// Starts no threads, logs nothing, knows no jobs. Equal arguments give equal bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/effects/effect_plan.hpp"
#include "raykiln/image/film.hpp"
#include "raykiln/image/layers.hpp"
#include "raykiln/integrator/camera_ray.hpp"    // PixelMode
#include "raykiln/integrator/render_stats.hpp"  // RenderStats
#include "raykiln/sampling/random.hpp"          // Sampler
#include "raykiln/scene/scene.hpp"
#include "raykiln/shading/bsdf.hpp"  // DirectionSampling
#include "raykiln/shading/emitter_choice.hpp"
#include "raykiln/shading/light_model.hpp"
#include "raykiln/shading/texture_pyramid.hpp"

namespace raykiln::render {

/// The whole picture of which a window is rendered, and where in it the window's pixel (0, 0) lies.
struct Crop {
  int x = 0, y = 0;
  int full_width = 0, full_height = 0;
};

struct RenderSettings {
  int width = 640, height = 480;
  std::optional<Crop> crop{};    ///< unset: width x height is the whole picture. Pixels are those of the whole
  int camera = 0;                ///< index into Scene::cameras
  std::optional<Camera> own_camera{};  ///< used instead of `camera` when set; as in Scene::cameras
  LightModel light_model = kPhysicalModel;
  std::optional<int> max_depth{};  ///< reflections after the first hit; unset: see path_limit()
  int branches = 1;              ///< rays shot from each hit; more than 1 is the seed's tree
  std::uint64_t seed = 0;
  Sampler sampler = Sampler::kRandom;
  PixelMode pixel_mode = PixelMode::kRandom;
  PixelFilter pixel_filter = PixelFilter::kBox;  ///< of PixelMode::kRandom
  DirectionSampling direction_sampling = DirectionSampling::kBsdf;
  bool emitter_sampling = true;  ///< with multiple importance sampling
  EmitterChoice emitter_choice = EmitterChoice::kAuto;
  TextureReading texture_reading = TextureReading::kExact;  ///< kFootprint is biased, and told by a notice
  Traversal traversal = Traversal::kTree;
  EffectChoice effects{};        ///< kAuto and kAll give the same bytes
  LayerSet layers{};             ///< made beside the picture, whose bytes they leave alone
};

/// Limits that settings_error() checks.
inline constexpr int kLargestSide = 32768;       ///< pixels
inline constexpr int kLargestDepth = 4096;       ///< reflections after the first hit
inline constexpr int kMostBranches = 64;         ///< rays shot from each hit
inline constexpr double kMostRaysOfPath = 65536; ///< 1 + b + b^2 + ... of the seed's tree

/// Hard limit of paths that roulette ends, if unset. Lossless traps never lose throughput: of the light
/// that gets into a faceted body of index n, (1 - (1 - F)/n^2)^limit is cut off.
inline constexpr int kRouletteLimit = 1024;
inline constexpr int kFixedDepth = 8;       ///< depth of all other paths, if unset

/// Reflections after the first hit at which every path ends. What is cut off there while it could go
/// on is counted as truncated: with roulette next to nothing, else the bias of a fixed depth.
[[nodiscard]] int path_limit(const RenderSettings& settings);

/// Bytes that a film of this size takes; saturates. What a job must be checked against before.
[[nodiscard]] std::uint64_t film_bytes(int width, int height);

/// An empty film for a picture with these settings: it knows what variances may be taken from.
[[nodiscard]] Film make_film(const RenderSettings& settings);
[[nodiscard]] SampleRelation sample_relation(Sampler sampler);

/// First thing that is wrong with the settings for this scene, or nothing.
[[nodiscard]] std::optional<std::string> settings_error(const RenderSettings& settings,
                                                        const Scene& scene);

/// The camera that these settings look through. Precondition: settings_error() is nothing.
[[nodiscard]] const Camera& camera_of(const RenderSettings& settings, const Scene& scene);

/// What is known to be wrong with a light model in this scene, for people beside the picture.
struct LightModelWarning {
  std::string code;     ///< "heavy_tailed" or "not_conserving_refraction"
  std::string message;
};
[[nodiscard]] std::vector<LightModelWarning> light_model_warnings(const LightModel& model,
                                                                  const Scene& scene);

/// Which effects these settings simulate in this scene, and why. The first walks all triangles.
[[nodiscard]] EffectPlan effect_plan(const RenderSettings& settings, const Scene& scene);

/// What is worth knowing beside a picture: "tree_no_benefit" where no split of the tree pays,
/// "tree_budget_reached" where its bound on references or bytes stopped one in a thousand splits and more,
/// "textures_by_footprint" where their values are means, and
/// "unresolved_sharp_highlight" where mirrors show point lights, spots or suns smaller than samples can find.
/// Precondition: settings_error() is nothing.
struct RenderNotice {
  std::string code;
  std::string message;
};
[[nodiscard]] std::vector<RenderNotice> render_notices(const RenderSettings& settings,
                                                       const Scene& scene, const BuildStats& tree);

/// Scene and tree with what shading needs beside them (emitter distribution, ...). Immutable; shared
/// by all threads.
class PreparedScene;
[[nodiscard]] std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene,
                                                           std::shared_ptr<const KdTree> tree);
[[nodiscard]] EffectPlan effect_plan(const RenderSettings& settings, const PreparedScene& scene);

/// The builder's view of a scene's triangles (spans into `scene`) and the tree for it; null if stopped.
[[nodiscard]] std::shared_ptr<const KdTree> build_scene_tree(const Scene& scene,
                                                             const BuildParams& params,
                                                             TaskRunner& runner);

struct TileResult {
  PixelRect rect;
  std::vector<BlockResult> blocks;
  std::vector<LayerBlock> layers{};    ///< one a block; empty where no layer is asked for
  RenderStats stats;
  std::vector<BadSample> bad_samples;  ///< at most 16 located ones
  bool stopped = false;                ///< stop was requested: the blocks must not be folded
};

/// Renders the blocks over the pixels of `rect`. Pure: any thread, any order, same bytes. `stop` is
/// polled at least every few milliseconds.
[[nodiscard]] TileResult render_tile(const PreparedScene& scene, const RenderSettings& settings,
                                     const PixelRect& rect, std::span<const SampleBlock> blocks,
                                     std::stop_token stop);

/// Folds all blocks of the result, in their order; nothing of one that was stopped.
void merge(Film& film, const TileResult& result);
/// The same for its layers, which are those of `film`.
void merge(LayerFilm& film, const TileResult& result);

}  // namespace raykiln::render
