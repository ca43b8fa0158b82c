#include <algorithm>
#include <memory>

#include "raykiln/scene/surface_textures.hpp"
#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

/// First material in use with a picture that its factors do not make black.
const Material* textured_material(const EffectView& view) {
  if (view.scene.textures == nullptr) return nullptr;
  const auto& textures = view.scene.textures->materials;
  for (const std::uint32_t id : view.use.materials) {
    if (id >= textures.size()) continue;
    const Material& m = view.scene.materials[id];
    const MaterialTextures& used = textures[id];
    const bool base =
        (used.base.used() || used.roughness.used() || used.normal.used()) && is_reflecting(m);
    if (base || (textures[id].emission.used() && !is_black(m.emission))) return &m;
  }
  return nullptr;
}

Judgement judge(const EffectView& view) {
  const Material* m = textured_material(view);
  return of_surface(view, m, m != nullptr ? named(*m) + " has a texture" : "",
                    "no material in use has a texture");
}

/// Two by two texels over every triangle of the material, added to the textures there are.
void provoke(const EffectExample& at) {
  SurfaceTextures textures =
      at.scene.textures != nullptr ? *at.scene.textures : SurfaceTextures{};
  Material& material = at.scene.materials[at.material];
  if (!is_reflecting(material)) material.diffuse = Rgb(0.8F);
  const auto image = static_cast<std::uint32_t>(textures.images.size());
  textures.images.push_back({.name = "example",
                             .width = 2,
                             .height = 2,
                             .srgb8 = {250, 40, 30, 20, 30, 200, 10, 220, 90, 128, 128, 128},
                             .linear = {}});
  UvSet& set = textures.uv_sets[0];
  const auto first = static_cast<std::uint32_t>(set.coordinates.size());
  set.coordinates.insert(set.coordinates.end(),
                         {{0.1F, 0.2F}, {1.7F, 0.3F}, {0.4F, 1.9F}});
  set.corners.resize(at.scene.mesh.triangles.size(), {kNoUv, kNoUv, kNoUv});
  for (std::size_t id = 0; id < at.scene.mesh.triangles.size(); ++id) {
    if (at.scene.mesh.material_ids[id] == at.material) set.corners[id] = {first, first + 1, first + 2};
  }
  textures.materials.resize(std::max(textures.materials.size(), at.scene.materials.size()));
  textures.materials[at.material].base.image = image;
  at.scene.textures = std::make_shared<const SurfaceTextures>(std::move(textures));
}

}  // namespace

const EffectRow kTexturesRow{.effect = Effect::kTextures,
                             .name = "textures",
                             .left_out = "texture coordinates and looking pictures up at hits",
                             .grade = Grade::kUnbounded,
                             .judge = judge,
                             .provoke = provoke};

}  // namespace raykiln::render
