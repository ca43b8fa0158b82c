#include <utility>

#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  const Material* m = find_material(view, [](const Material& c) { return c.one_sided; });
  return of_surface(view, m, m != nullptr ? named(*m) + " has no back" : "",
                    "all materials in use have two sides");
}

/// Turned about, so that its back is what is seen of a body.
void provoke(const EffectExample& at) {
  Material& material = at.scene.materials[at.material];
  if (!is_reflecting(material)) material.diffuse = {0.3F, 0.4F, 0.6F};
  material.one_sided = true;
  TriangleMesh& mesh = at.scene.mesh;
  for (std::size_t id = 0; id < mesh.triangles.size(); ++id) {
    if (mesh.material_ids[id] == at.material) std::swap(mesh.triangles[id][1], mesh.triangles[id][2]);
  }
}

}  // namespace

const EffectRow kOneSidedSurfacesRow{
    .effect = Effect::kOneSidedSurfaces,
    .name = "one_sided_surfaces",
    .left_out = "asking at hits for the side, and rays that go on where it is the back",
    .grade = Grade::kUnbounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
