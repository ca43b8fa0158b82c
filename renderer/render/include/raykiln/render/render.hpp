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
#include "raykiln/image/film.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

enum class LightModel : std::uint8_t { kSeed };
enum class PixelMode : std::uint8_t { kRandom, kCentre };
enum class DirectionSampling : std::uint8_t { kBsdf, kUniformSphere };

struct RenderSettings {
  int width = 640, height = 480;
  int camera = 0;                ///< index into Scene::cameras
  std::optional<Camera> own_camera{};  ///< used instead of `camera` when set; as in Scene::cameras
  LightModel light_model = LightModel::kSeed;
  int max_depth = 8;             ///< reflections after the first hit
  int branches = 1;              ///< rays shot from each hit; more than 1 is the seed's tree
  std::uint64_t seed = 0;
  PixelMode pixel_mode = PixelMode::kRandom;
  DirectionSampling direction_sampling = DirectionSampling::kBsdf;
  bool emitter_sampling = true;  ///< with multiple importance sampling
  Traversal traversal = Traversal::kTree;
};

/// First thing that is wrong with the settings for this scene, or nothing.
[[nodiscard]] std::optional<std::string> settings_error(const RenderSettings& settings,
                                                        const Scene& scene);

/// Scene and tree with what shading needs beside them (emitter distribution, ...). Immutable; shared
/// by all threads.
class PreparedScene;
[[nodiscard]] std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene,
                                                           std::shared_ptr<const KdTree> tree);

/// The builder's view of a scene's triangles (spans into `scene`) and the tree for it; null if stopped.
[[nodiscard]] std::shared_ptr<const KdTree> build_scene_tree(const Scene& scene,
                                                             const BuildParams& params,
                                                             TaskRunner& runner);

/// Counts of one task; sums over tasks do not depend on how the work was cut, `seconds` apart.
struct RenderStats {
  std::uint64_t camera_rays = 0, bounce_rays = 0, shadow_rays = 0;
  std::uint64_t paths = 0, non_finite = 0, negative = 0, truncated = 0;
  std::uint64_t closest_calls = 0;            ///< calls of closest_hits
  std::uint64_t short_calls_while_many_live = 0;  ///< fewer than 1024 rays although as many paths lived
  TraversalCounters traversal;
};

struct TileResult {
  PixelRect rect;
  std::vector<BlockResult> blocks;
  RenderStats stats;
  std::vector<BadSample> bad_samples;  ///< at most 16 located ones
  bool stopped = false;                ///< stop was requested: the blocks must not be folded
};

/// Renders the blocks over the pixels of `rect`. Pure: any thread, any order, same bytes. `stop` is
/// polled at least every few milliseconds.
[[nodiscard]] TileResult render_tile(const PreparedScene& scene, const RenderSettings& settings,
                                     const PixelRect& rect, std::span<const SampleBlock> blocks,
                                     std::stop_token stop);

/// Folds all blocks of the result, in their order.
void merge(Film& film, const TileResult& result);

}  // namespace raykiln::render
