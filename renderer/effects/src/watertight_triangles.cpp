#include "rows.hpp"
#include "sources.hpp"

namespace raykiln::render {
namespace {

Judgement judge(const EffectView& view) {
  if (!has_light(view)) return {false, "there is no light in the scene"};
  if (view.use.materials.empty()) return {false, "there is no triangle in the scene"};
  return {true, std::to_string(view.scene.mesh.triangles.size()) + " triangles"};
}

/// Wherever there are surfaces and light.
void provoke(const EffectExample& /*at*/) {}

}  // namespace

const EffectRow kWatertightTrianglesRow{
    .effect = Effect::kWatertightTriangles,
    .name = "watertight_triangles",
    .left_out = "the bounds on rounding in the triangle test, and deciding in double: rays may slip "
                "through where triangles are a few roundings wide",
    .grade = Grade::kUnbounded,
    .judge = judge,
    .provoke = provoke};

}  // namespace raykiln::render
