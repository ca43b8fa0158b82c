#include "first_surface.hpp"

#include "raykiln/shading/surface_point.hpp"
#include "raykiln/shading/texture_lookup.hpp"

namespace raykiln::render {
namespace {

/// The share of light from along the normal that goes on from the surface, to either side. Facets reflect
/// `specular` of it; the rest meets the base or goes through.
Rgbd albedo_of(const Material& m) {
  const Rgbd diffuse(m.diffuse), specular(m.specular);
  if (m.model == SurfaceModel::kPhong) return diffuse + specular;
  const auto clear = static_cast<double>(m.transparent);
  const Rgbd base = diffuse + Rgbd(m.facets.diffuse_through);
  return specular + (Rgbd(1.0) - specular) * ((1.0 - clear) * base + clear * Rgbd(m.facets.tint));
}

bool emission_is_told_apart(const PathSettings& settings) {
  return settings.left_out.contains(Effect::kPointLightShadows);
}

}  // namespace

LayerSample first_surface(const Transport& transport, const CameraRays& camera, const Ray& ray, const Hit& hit,
                          Material& painted) {
  LayerSample sample;
  if (hit.id == kNoHit) return sample;
  const TrianglePlace place{hit.id, static_cast<double>(hit.u), static_cast<double>(hit.v)};
  const SurfacePoint point = surface_point(transport.mesh, hit.id, place.u, place.v, transport.normals);
  const Material* material = &transport.scene.materials[point.material];
  Vec3d normal(point.ns);
  if (transport.textures != nullptr) {
    paint(*transport.textures, *material, point.material, place, painted);
    material = &painted;
    const auto bent = mapped_normal(*transport.textures, transport.mesh, point.material, place, point.ns);
    if (bent) normal = Vec3d(*bent);
  }
  sample.met = true;
  sample.albedo = albedo_of(*material);
  sample.normal = dot(point.ng, Vec3d(ray.d)) > 0.0 ? -normal : normal;
  sample.depth = camera.depth(point.p);
  sample.object = object_of(transport.mesh, hit.id) + 1;
  sample.material = point.material + 1;
  const PathSettings& settings = transport.settings;
  if (emission_is_told_apart(settings) && !settings.left_out.contains(Effect::kAreaEmitters)) {
    sample.emission = Rgbd(material->emission);
  }
  return sample;
}

void mark_light(const Transport& transport, std::span<const PathState> shaded, std::span<const PathResult> results,
                std::span<LayerSample> layers) {
  const bool told_apart = emission_is_told_apart(transport.settings);
  for (const PathState& state : shaded) {
    if (state.bounce > 1) continue;
    LayerSample& sample = layers[state.slot];
    const PathResult& result = results[state.slot];
    sample.indirect = result.emitted;
    if (state.bounce > 0) continue;
    sample.direct = result.direct;
    if (!(told_apart && sample.met)) sample.emission = result.emitted;
  }
}

void divide_light(std::span<const PathResult> results, std::span<LayerSample> layers) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    LayerSample& sample = layers[i];
    const Rgbd found = sample.indirect - sample.emission;  // by the first ray that was scattered
    sample.indirect = (results[i].emitted - sample.indirect) + (results[i].direct - sample.direct);
    sample.direct += found;
  }
}

}  // namespace raykiln::render
