#include "raykiln/shading/emitters.hpp"

#include <algorithm>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/environment_light.hpp"
#include "raykiln/shading/texture_lookup.hpp"

namespace raykiln::render {
namespace {

double largest_channel(const Rgb& c) {
  return static_cast<double>(std::max({c.x, c.y, c.z, 0.0F}));
}

/// Normal to the triangle, as long as twice its area.
Vec3d triangle_span(const TriangleMesh& mesh, std::uint32_t id) {
  const auto& corner = mesh.triangles[id];
  const Vec3d p0(mesh.positions[corner[0]]);
  return cross(Vec3d(mesh.positions[corner[1]]) - p0, Vec3d(mesh.positions[corner[2]]) - p0);
}

double triangle_area(const TriangleMesh& mesh, std::uint32_t id) {
  return 0.5 * length(triangle_span(mesh, id));
}

EmitterBounds bounds_of(const TriangleMesh& mesh, std::uint32_t id, double power) {
  Bounds3f box;
  for (const std::uint32_t corner : mesh.triangles[id]) box.grow(mesh.positions[corner]);
  return {.lo = box.lo, .hi = box.hi, .axis = Vec3f(normalize(triangle_span(mesh, id))), .power = power};
}

/// What the emission of each material counts for, W sr^-1 m^-2: its largest channel times the mean of
/// its texture.
std::vector<double> emission_weights(const Scene& scene) {
  std::vector<double> weights;
  weights.reserve(scene.materials.size());
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    weights.push_back(largest_channel(scene.materials[i].emission));
    if (!(weights.back() > 0.0) || scene.textures == nullptr) continue;
    if (i >= scene.textures->materials.size()) continue;
    const TextureUse& use = scene.textures->materials[i].emission;
    if (use.used()) weights.back() *= mean_largest_channel(scene.textures->images[use.image]);
  }
  return weights;
}

/// Those with power above 0.
template <class Light>
std::vector<Light> shining(const std::vector<Light>& lights, Rgb Light::*power) {
  std::vector<Light> kept;
  std::copy_if(lights.begin(), lights.end(), std::back_inserter(kept),
               [power](const Light& light) { return largest_channel(light.*power) > 0.0; });
  return kept;
}

std::shared_ptr<const EnvironmentLight> environment_of(const Scene& scene) {
  if (scene.environment == nullptr) return nullptr;
  auto light = std::make_shared<const EnvironmentLight>(scene.environment);
  return light->shines() ? light : nullptr;
}

}  // namespace

// The density of a point: (L_max A / total) (1 / A), the area cancels.
Emitters::Emitters(const Scene& scene) {
  const std::vector<double> weights = emission_weights(scene);
  std::vector<double> power;
  for (std::uint32_t id = 0; id < scene.mesh.triangles.size(); ++id) {
    const double radiance = weights[scene.mesh.material_ids[id]];
    if (!(radiance > 0.0)) continue;
    const double weight = radiance * triangle_area(scene.mesh, id);
    if (!(weight > 0.0)) continue;
    triangles_.push_back(id);
    power.push_back(weight);
  }
  distribution_ = DiscreteDistribution(power);
  std::vector<EmitterBounds> leaves;
  leaves.reserve(triangles_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    leaves.push_back(bounds_of(scene.mesh, triangles_[i], power[i]));
  }
  tree_ = LightTree(leaves);
  if (has_triangles()) {
    pdf_area_.reserve(scene.materials.size());
    for (const double weight : weights) pdf_area_.push_back(weight / distribution_.total());
  }
  point_lights_ = shining(scene.point_lights, &PointLight::intensity);
  spot_lights_ = shining(scene.spot_lights, &SpotLight::intensity);
  directional_lights_ = shining(scene.directional_lights, &DirectionalLight::irradiance);
  environment_ = environment_of(scene);
}

EmitterSample Emitters::point_on(const Scene& scene, std::uint32_t triangle,
                                 const VertexKey& vertex) const {
  const TrianglePoint b = sample_uniform_triangle(uniform(vertex, Dimension::kLightU),
                                                  uniform(vertex, Dimension::kLightV));
  EmitterSample sample;
  sample.triangle = triangle;
  sample.u = b.b1;
  sample.v = b.b2;
  sample.point = surface_point(scene.mesh, triangle, b.b1, b.b2);
  sample.radiance = Rgbd(scene.materials[sample.point.material].emission);
  return sample;
}

EmitterSample Emitters::sample(const Scene& scene, const VertexKey& vertex) const {
  const std::size_t drawn = distribution_.sample(uniform(vertex, Dimension::kLightChoice));
  EmitterSample sample = point_on(scene, triangles_[drawn], vertex);
  sample.pdf_area = pdf_area(sample.point.material);
  return sample;
}

EmitterSample Emitters::sample(const Scene& scene, const VertexKey& vertex,
                               const EmitterReceiver& receiver) const {
  const auto drawn = tree_.sample(receiver, uniform(vertex, Dimension::kLightChoice));
  if (!drawn) return {};
  const std::uint32_t triangle = triangles_[drawn->emitter];
  EmitterSample sample = point_on(scene, triangle, vertex);
  sample.pdf_area = drawn->probability / triangle_area(scene.mesh, triangle);
  return sample;
}

double Emitters::pdf_area(const Scene& scene, std::uint32_t triangle,
                          const EmitterReceiver& receiver) const {
  const auto found = std::lower_bound(triangles_.begin(), triangles_.end(), triangle);
  if (found == triangles_.end() || *found != triangle) return 0.0;
  const auto emitter = static_cast<std::uint32_t>(found - triangles_.begin());
  return tree_.probability(receiver, emitter) / triangle_area(scene.mesh, triangle);
}

}  // namespace raykiln::render
