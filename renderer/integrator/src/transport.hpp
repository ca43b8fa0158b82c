// What light is carried through, with the effects that are left out taken out of it.
#pragma once

#include <span>

#include "raykiln/integrator/path_tracer.hpp"
#include "raykiln/shading/coverage.hpp"

namespace raykiln::render {

/// Reflections after which roulette may end a path, and what it multiplies the throughput by to get the chance
/// of going on: see renderer/integrator/README.md.
inline constexpr int kFirstDrawAfter = 1;
inline constexpr double kRouletteFactor = 3.0;

/// Data of effects that are not simulated are not here: no point light, a black background, no
/// environment, no textures, roulette off.
struct Transport {
  const Scene& scene;
  const TriangleMesh& mesh;
  const KdTree& tree;
  const Emitters& emitters;
  std::span<const PointLight> point_lights;
  std::span<const SpotLight> spot_lights;
  std::span<const DirectionalLight> directional_lights;
  Rgb background{0.0F};
  const EnvironmentLight* environment = nullptr;
  bool environment_sampling = false;  ///< shadow rays are sent to it, too
  bool emitters_by_tree = false;      ///< where they are sampled
  const SurfaceTextures* textures = nullptr;
  const TexturePyramids* pyramids = nullptr;  ///< where textures are read by footprint
  std::span<const CausticCaster> casters{};  ///< towards which diffuse surfaces draw directions
  bool normals = true;    ///< shading normals are interpolated
  Gaps gaps{};            ///< where light passes straight through surfaces
  bool has_light = true;  ///< any at all; without, nothing is lost where a path is cut off
  PathSettings settings;  ///< emitter_sampling: of triangles

  /// Lights that no ray can find: added at every hit.
  [[nodiscard]] bool has_lights_without_surface() const {
    return !point_lights.empty() || !spot_lights.empty() || !directional_lights.empty();
  }
};

[[nodiscard]] Transport make_transport(const TransportScene& scene, const PathSettings& settings);

/// Parts of the code that an instance of the shading loop has.
struct Switches {
  bool rich = true;          ///< textures, microfacets: what files of glTF have and the seed has not
  bool transmission = true;  ///< light may come from or go to the far side of a surface
  bool specular = true;      ///< Phong lobes
  bool normals = true;       ///< shading normals
  bool bounces = true;       ///< paths go on after the first hit
  bool reduced = false;      ///< something that is called for is left out: asked at every vertex
};

// One instance a switch, each with one switch less than the one before; not one a combination.
inline constexpr Switches kGeneral{};
inline constexpr Switches kReduced{.reduced = true};
inline constexpr Switches kPhong{.rich = false};
inline constexpr Switches kOpaque{.rich = false, .transmission = false};
inline constexpr Switches kMatte{.rich = false, .transmission = false, .specular = false};
inline constexpr Switches kFlatMatte{
    .rich = false, .transmission = false, .specular = false, .normals = false};
inline constexpr Switches kDirectFlatMatte{.rich = false,
                                           .transmission = false,
                                           .specular = false,
                                           .normals = false,
                                           .bounces = false};

/// The switches of the leanest instance that can simulate what is to be simulated.
[[nodiscard]] Switches switches_for(const Transport& transport);

}  // namespace raykiln::render
