// One row of the table of effects: when an effect is called for, and what leaving it out does.
#pragma once

#include <span>
#include <string>

#include "raykiln/effects/effect.hpp"
#include "raykiln/effects/scene_use.hpp"
#include "raykiln/shading/light_model.hpp"

namespace raykiln::render {

/// Lobes at least this sharp count as mirrors, broader ones as gloss.
inline constexpr double kMirrorExponent = 1e8;

/// What leaving an effect out does to the picture.
enum class Grade : std::uint8_t {
  kIdentical,  ///< not a bit of any plane of the film changes
  kUnbiased,   ///< the same mean, other noise
  kBounded,  ///< light is lost and none is added: no darker than black, no brighter than the truth
  kUnbounded,  ///< light goes elsewhere
};
[[nodiscard]] std::string_view name(Grade grade);

/// What of a job decides effects.
struct EffectJob {
  LightModel light_model = kPhysicalModel;
  int max_depth = 8;  ///< reflections after the first hit
  bool emitter_sampling = true;
  double lens_radius = 0.0;  ///< of the camera, metres
};

struct EffectView {
  const Scene& scene;
  const SceneUse& use;
  const EffectJob& job;
};

struct Judgement {
  bool called_for = false;
  std::string evidence;  ///< for people: the material, light or setting that decides
};

/// Where a row makes a scene call for its effect.
struct EffectExample {
  Scene& scene;
  EffectJob& job;
  std::uint32_t material = 0;  ///< some triangles have it, and they alone; free to be changed
};

struct EffectRow {
  Effect effect;
  const char* name;
  const char* left_out;  ///< code, data and rays that are absent where it is not simulated
  Grade grade;  ///< of leaving it out by name where it is called for
  /// Says that the effect is not called for only where leaving it out is kIdentical: that is what
  /// auto leaves out.
  Judgement (*judge)(const EffectView&);
  /// Adds what calls for the effect, where reflecting surfaces and light are there: tests draw
  /// their scenes with it, so that they know an effect as soon as it has a row.
  void (*provoke)(const EffectExample&);
};

/// All rows, the one of effect e at index e.
[[nodiscard]] std::span<const EffectRow* const> effect_table();
[[nodiscard]] const EffectRow& row_of(Effect effect);

}  // namespace raykiln::render
