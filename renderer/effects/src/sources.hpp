// Questions that several rows ask of a scene.
#pragma once

#include <string>

#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {

[[nodiscard]] inline bool is_sharp(const Material& m) { return m.specular_exp >= kMirrorExponent; }

[[nodiscard]] inline bool is_reflecting(const Material& m) { return scatters(m); }

[[nodiscard]] inline bool has_facets(const Material& m) {
  return m.model == SurfaceModel::kMicrofacet && scatters(m);
}

/// Of the seed's model.
[[nodiscard]] inline bool has_phong_lobe(const Material& m) {
  return m.model == SurfaceModel::kPhong && !is_black(m.specular);
}

/// Of either model.
[[nodiscard]] inline bool is_specular(const Material& m) {
  return has_phong_lobe(m) || (has_facets(m) && (!is_black(m.specular) || m.transparent > 0.0F || m.facets.edge > 0.0F));
}

/// A border between media: light may be refracted.
[[nodiscard]] inline bool has_border(const Material& m) {
  return m.transparent > 0.0F && (has_facets(m) || has_phong_lobe(m));
}

/// First material in use for which `holds`; null if there is none.
template <class Predicate>
const Material* find_material(const EffectView& view, Predicate&& holds) {
  for (const std::uint32_t id : view.use.materials) {
    if (holds(view.scene.materials[id])) return &view.scene.materials[id];
  }
  return nullptr;
}

[[nodiscard]] const Material* emitting_material(const EffectView& view);
[[nodiscard]] const Material* reflecting_material(const EffectView& view);

/// Is there any light at all, from lights without a surface, emitters, background or environment?
[[nodiscard]] bool has_light(const EffectView& view);

/// Can light reach the camera by way of two surfaces? Lights without a surface add at every hit,
/// emitters, background and environment where a further ray finds them.
[[nodiscard]] bool reaches_two_surfaces(const EffectView& view);

/// "material `glass`", its name cut to 60 bytes.
[[nodiscard]] std::string named(const Material& material);
/// "material `glass`: transparent 1"
[[nodiscard]] std::string says(const Material& material, const char* field, double value);
[[nodiscard]] std::string says(const Material& material, const char* field, const Rgb& value);
[[nodiscard]] std::string text(const Rgb& value);

/// Verdict of an effect of `count` shining lights of a kind: "point light".
[[nodiscard]] Judgement of_lights(const EffectView& view, std::uint64_t count,
                                  const std::string& kind);

/// Verdict of an effect of surfaces: called for by `material` where there is light at all.
[[nodiscard]] Judgement of_surface(const EffectView& view, const Material* material,
                                   const std::string& evidence, const char* otherwise);

/// The fewest digits that read back as this number.
[[nodiscard]] std::string shortest(double value);

}  // namespace raykiln::render
