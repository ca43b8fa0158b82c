// Radiance along many camera paths at once, advanced together bounce by bounce.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string_view>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/effects/effect.hpp"
#include "raykiln/image/layers.hpp"
#include "raykiln/integrator/camera_ray.hpp"
#include "raykiln/integrator/render_stats.hpp"
#include "raykiln/scene/scene.hpp"
#include "raykiln/shading/bsdf.hpp"
#include "raykiln/shading/caustic_casters.hpp"
#include "raykiln/shading/emitters.hpp"
#include "raykiln/shading/texture_pyramid.hpp"

namespace raykiln::render {

/// What light is carried through. All of it outlives the tracer.
struct TransportScene {
  const Scene& scene;
  const KdTree& tree;
  const Emitters& emitters;
  const TexturePyramids* pyramids = nullptr;  ///< of its textures; null: they are read exactly, whatever is asked for
  std::span<const CausticCaster> casters{};   ///< towards which diffuse surfaces draw directions, too, where triangles shine
};

struct PathSettings {
  std::uint64_t seed = 0;
  Sampler sampler = Sampler::kRandom;
  int max_depth = 8;  ///< reflections after the first hit; with roulette (in `bsdf`) a hard limit
  int branches = 1;   ///< rays shot from each hit
  PixelMode pixel_mode = PixelMode::kRandom;
  PixelFilter pixel_filter = PixelFilter::kBox;
  int window_x = 0, window_y = 0;  ///< where pixel (0, 0) lies in the camera's picture
  bool emitter_sampling = true;
  EmitterChoice emitter_choice = EmitterChoice::kAuto;
  TextureReading texture_reading = TextureReading::kExact;
  BsdfModel bsdf;
  Traversal traversal = Traversal::kTree;
  /// What is to be simulated. Precondition: what is missing here is not called for, or in left_out.
  EffectSet simulated = EffectSet::everything();
  EffectSet left_out{};  ///< not simulated although the scene calls for it
};

/// Pixel and sample index: with the seed, all that the numbers of a path depend on.
struct PathStart {
  int x = 0, y = 0;
  std::uint64_t sample = 0;
};

/// The two sums are kept apart so that each is added up in an order that only the path decides.
struct PathResult {
  Rgbd emitted{0.0};  ///< light found by following the path
  Rgbd direct{0.0};   ///< light found by shadow rays
  bool truncated = false;  ///< could have gone on at max_depth
  [[nodiscard]] Rgbd radiance() const { return emitted + direct; }
};

/// Rays of the tree that one camera ray can grow with these settings: 1 + b + b^2 + ... + b^depth;
/// infinity rather than overflow.
[[nodiscard]] double rays_of_one_path(int branches, int max_depth);

class PathStream;

/// Owns the scratch memory of one thread; reuse it for all calls of a task. A result depends on
/// its PathStart alone, not on the others in the call.
class PathTracer {
 public:
  PathTracer(const TransportScene& scene, const CameraRays& camera, const PathSettings& settings);
  ~PathTracer();
  PathTracer(const PathTracer&) = delete;
  PathTracer& operator=(const PathTracer&) = delete;

  /// Fills results[i] for starts[i], and layers[i] unless there are none. Returns false, with results
  /// unusable, once stop is requested; it is polled before every call into the tree.
  [[nodiscard]] bool trace(std::span<const PathStart> starts, std::span<PathResult> results,
                           RenderStats& stats, const std::stop_token& stop,
                           std::span<LayerSample> layers = {});

  /// The instance of the shading loop that runs: "general", "reduced", "opaque", "matte",
  /// "flat_matte" or "direct_flat_matte".
  [[nodiscard]] std::string_view shading_loop() const;

 private:
  struct Scratch;
  struct Call;
  void admit(Call& call);  ///< shoots camera rays while there is room under way
  /// The same one by one, without what goes beside rays and states.
  void shoot(std::span<const PathStart> starts, std::uint32_t first_slot, PathStream& into) const;
  void advance(Call& call, std::size_t begin, std::size_t end);  ///< one reflection of these paths
  void shade(Call& call, std::size_t begin, std::size_t end);
  void look(Call& call, std::size_t begin, std::size_t end);  ///< what these camera rays met
  void dark(Call& call);  ///< where there is no light: one look along each camera ray, if any is asked for
  CameraRays camera_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace raykiln::render
