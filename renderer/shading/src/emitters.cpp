#include "raykiln/shading/emitters.hpp"

#include <algorithm>
#include <limits>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/coverage.hpp"
#include "raykiln/shading/environment_light.hpp"
#include "raykiln/shading/texture_lookup.hpp"
#include "triangle_span.hpp"

namespace raykiln::render {
namespace {

double largest_channel(const Rgb& c) {
  return static_cast<double>(std::max({c.x, c.y, c.z, 0.0F}));
}

/// What the emission of each material counts for, W sr^-1 m^-2: its largest channel times the means of
/// its texture and its coverage.
std::vector<double> emission_weights(const Scene& scene) {
  std::vector<double> weights;
  weights.reserve(scene.materials.size());
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    weights.push_back(largest_channel(scene.materials[i].emission));
    if (!(weights.back() > 0.0)) continue;
    const auto id = static_cast<std::uint32_t>(i);
    if (has_open_parts(scene, id)) weights.back() *= mean_coverage(scene, id);
    if (scene.textures == nullptr) continue;
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
  std::vector<double> weights = emission_weights(scene);
  std::vector<double> power;
  for (std::uint32_t id = 0; id < scene.mesh.triangles.size(); ++id) {
    const double radiance = weights[scene.mesh.material_ids[id]];
    if (!(radiance > 0.0)) continue;
    const double weight = radiance * triangle_area(scene.mesh, id);
    if (!(weight > 0.0)) continue;
    triangles_.push_back(id);
    power.push_back(weight);
    for (const std::uint32_t corner : scene.mesh.triangles[id]) box_.grow(scene.mesh.positions[corner]);
  }
  distribution_ = DiscreteDistribution(power);
  if (has_triangles()) {
    weights_ = std::move(weights);
    tree_ = std::make_unique<TreeOnDemand>();
    tree_bytes_ = EmitterTree::bytes(triangles_.size(), scene.mesh.triangles.size());
  }
  point_lights_ = shining(scene.point_lights, &PointLight::intensity);
  spot_lights_ = shining(scene.spot_lights, &SpotLight::intensity);
  directional_lights_ = shining(scene.directional_lights, &DirectionalLight::irradiance);
  environment_ = environment_of(scene);
}

// A point s away lies no farther than s times the width from the place s along the axis, and s is at most the way
// to the box's farthest corner: the half line is met with a box that is larger by that, and by as much again and
// more than doubles round for safety.
bool Emitters::may_lie_along(const Vec3d& from, const Vec3f& axis, double width) const {
  const Vec3d lo(box_.lo), hi(box_.hi), d(axis);
  const double farthest = length(glm::max(abs(lo - from), abs(hi - from)));
  const Vec3d coordinates = abs(from) + abs(lo) + abs(hi);
  const double margin = 2.0 * width * farthest + 0x1p-40 * (coordinates.x + coordinates.y + coordinates.z);
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double below = lo[k] - margin - from[k], above = hi[k] + margin - from[k];
    if (d[k] == 0.0) {
      if (below > 0.0 || above < 0.0) return false;
      continue;
    }
    const double t0 = below / d[k], t1 = above / d[k];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return !(enter > leave);
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

const EmitterTree& Emitters::tree(const Scene& scene) const {
  if (!tree_->made.done()) make_tree(scene, {});
  return *tree_->tree;
}

bool Emitters::make_tree(const Scene& scene, const std::stop_token& stop) const {
  return tree_->made.once(stop, [&] {
    return tree_->tree.emplace(scene.mesh, triangles_, weights_, scene.materials, stop).whole();
  });
}

EmitterSample Emitters::sample(const Scene& scene, const VertexKey& vertex,
                               const EmitterReceiver& receiver) const {
  const auto drawn = tree(scene).sample(receiver, uniform(vertex, Dimension::kLightChoice));
  if (!drawn) return {};
  EmitterSample sample = point_on(scene, drawn->triangle, vertex);
  sample.pdf_area = drawn->pdf_area;
  return sample;
}

}  // namespace raykiln::render
