#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (!has_light(view)) return {false, "there is no light in the scene"};
  if (!view.use.smooth_triangle)
    return {false, "no reflecting triangle has normals other than that of its plane"};
  return {true,
          "triangle " + std::to_string(*view.use.smooth_triangle) + " has normals at its corners"};
}

void provoke(const EffectExample& at) {
  TriangleMesh& mesh = at.scene.mesh;
  if (!is_reflecting(at.scene.materials[at.material]))
    at.scene.materials[at.material].diffuse = Rgb(0.5F);
  mesh.corner_normals.resize(mesh.triangles.size(), {kNoNormal, kNoNormal, kNoNormal});
  for (std::size_t id = 0; id < mesh.triangles.size(); ++id) {
    if (mesh.material_ids[id] != at.material) continue;
    const auto& corner = mesh.triangles[id];
    const Vec3f& p0 = mesh.positions[corner[0]];
    const Vec3f ng =
        normalize(cross(mesh.positions[corner[1]] - p0, mesh.positions[corner[2]] - p0));
    const auto first = static_cast<std::uint32_t>(mesh.normals.size());
    for (const Vec3f& tilt : {Vec3f(0.2F, 0, 0), Vec3f(0, 0.2F, 0.1F), Vec3f(0, -0.1F, 0.2F)}) {
      mesh.normals.push_back(normalize(ng + tilt));
    }
    mesh.corner_normals[id] = {first, first + 1, first + 2};
  }
}

}  // namespace

const EffectRow kShadingNormalsRow{.effect = Effect::kShadingNormals,
                                   .name = "shading_normals",
                                   .left_out = "interpolating normals",
                                   .grade = Grade::kUnbounded,
                                   .judge = judge,
                                   .provoke = provoke};

}  // namespace raykiln::render
