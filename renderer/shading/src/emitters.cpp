#include "raykiln/shading/emitters.hpp"

#include <algorithm>

#include "raykiln/sampling/warp.hpp"

namespace raykiln::render {
namespace {

double largest_channel(const Rgb& c) {
  return static_cast<double>(std::max({c.x, c.y, c.z, 0.0F}));
}

double triangle_area(const TriangleMesh& mesh, std::uint32_t id) {
  const auto& corner = mesh.triangles[id];
  const Vec3d p0(mesh.positions[corner[0]]);
  return 0.5 * length(cross(Vec3d(mesh.positions[corner[1]]) - p0,
                            Vec3d(mesh.positions[corner[2]]) - p0));
}

}  // namespace

Emitters::Emitters(const Scene& scene) {
  std::vector<double> power;
  for (std::uint32_t id = 0; id < scene.mesh.triangles.size(); ++id) {
    const double radiance =
        largest_channel(scene.materials[scene.mesh.material_ids[id]].emission);
    if (!(radiance > 0.0)) continue;
    const double weight = radiance * triangle_area(scene.mesh, id);
    if (!(weight > 0.0)) continue;
    triangles_.push_back(id);
    power.push_back(weight);
  }
  distribution_ = DiscreteDistribution(power);
  std::copy_if(scene.point_lights.begin(), scene.point_lights.end(),
               std::back_inserter(point_lights_),
               [](const PointLight& light) { return largest_channel(light.intensity) > 0.0; });
}

EmitterSample Emitters::sample(const Scene& scene, const VertexKey& vertex) const {
  const std::size_t drawn = distribution_.sample(uniform(vertex, Dimension::kLightChoice));
  const TrianglePoint b = sample_uniform_triangle(uniform(vertex, Dimension::kLightU),
                                                  uniform(vertex, Dimension::kLightV));
  EmitterSample sample;
  sample.point = surface_point(scene.mesh, triangles_[drawn], b.b1, b.b2);
  const Rgb& radiance = scene.materials[sample.point.material].emission;
  sample.radiance = Rgbd(radiance);
  sample.pdf_area = pdf_area(radiance);
  return sample;
}

// (L_max A / total) (1 / A): the area cancels.
double Emitters::pdf_area(const Rgb& radiance) const {
  return largest_channel(radiance) / distribution_.total();
}

}  // namespace raykiln::render
