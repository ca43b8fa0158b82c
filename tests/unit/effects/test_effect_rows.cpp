// Each row: what calls for its effect, and what does not although it is in the scene.
#include <gtest/gtest.h>

#include <functional>

#include "raykiln/effects/effect_plan.hpp"
#include "raykiln/scene/environment_map.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

/// A matte box in a grey sky; the triangles of a second box have a black material of their own.
struct Case {
  support::SceneBuilder builder;
  EffectJob job{.max_depth = 0};
  std::uint32_t spare = 0;

  Case() {
    const auto matte = builder.material(support::diffuse_material(Rgb(0.5F)));
    spare = builder.material({});
    builder.scene().materials[matte].name = "matte";
    builder.scene().materials[spare].name = "spare";
    builder.box({-1, -1, -1}, {0, 0, 0}, matte);
    builder.box({0.1F, 0.1F, 0.1F}, {1, 1, 1}, spare);
    builder.scene().background = Rgb(0.5F);
  }
  Scene& scene() { return builder.scene(); }
  Material& material() { return scene().materials[spare]; }
  [[nodiscard]] EffectPlan plan(const EffectChoice& choice = {}) {
    return plan_effects(scene(), use_of(scene()), job, choice);
  }
  bool calls_for(Effect effect) { return plan().called_for.contains(effect); }
};

void put_out_lights(Scene& scene) {
  scene.point_lights.clear();
  scene.spot_lights.clear();
  scene.directional_lights.clear();
  scene.environment = nullptr;
}

TEST(EffectRows, EveryExampleCallsForItsEffect) {
  for (const EffectRow* row : effect_table()) {
    Case c;
    row->provoke({c.scene(), c.job, c.spare});
    EXPECT_TRUE(c.calls_for(row->effect)) << row->name;
  }
}

TEST(EffectRows, AMaterialThatNoTriangleHasCallsForNothing) {
  for (const EffectRow* row : effect_table()) {
    Case c;
    const EffectSet before = c.plan().called_for;
    const EffectJob job = c.job;
    row->provoke({c.scene(), c.job, c.spare});
    c.job = job;
    put_out_lights(c.scene());
    c.scene().mesh.corner_normals.clear();
    for (std::uint32_t& id : c.scene().mesh.material_ids) id = 0;
    EXPECT_TRUE(c.plan().called_for == before) << row->name;
  }
}

TEST(EffectRows, WithoutLightNothingIsCalledFor) {
  for (const EffectRow* row : effect_table()) {
    Case c;
    row->provoke({c.scene(), c.job, c.spare});
    c.scene().background = Rgb(0.0F);
    put_out_lights(c.scene());
    for (Material& m : c.scene().materials) m.emission = Rgb(0.0F);
    EXPECT_TRUE(c.plan().called_for.empty()) << row->name;
  }
}

struct Row {
  const char* what;
  Effect effect;
  bool called_for;
  std::function<void(Case&)> edit;
};

TEST(EffectRows, Conditions) {
  const auto light = [](float power) {
    return [power](Case& c) { c.builder.point_light({0, 3, 0}, Rgb(power)); };
  };
  const auto glass = [](float index) {
    return [index](Case& c) { c.material() = support::glass_material(index, 1e10); };
  };
  const auto depth = [](int d) { return [d](Case& c) { c.job.max_depth = d; }; };
  const std::vector<Row> rows{
      {"a light of power 0", Effect::kPointLights, false, light(0.0F)},
      {"a light of power 0", Effect::kPointLightShadows, false, light(0.0F)},
      {"a light with power", Effect::kPointLightShadows, true, light(1.0F)},
      {"a light, nothing reflects", Effect::kPointLights, false,
       [](Case& c) {
         c.builder.point_light({0, 3, 0}, Rgb(1.0F));
         c.scene().materials[0] = {};
       }},
      {"a spot of power 0", Effect::kSpotLights, false,
       [](Case& c) { c.scene().spot_lights.push_back({}); }},
      {"a sun of power 0", Effect::kDirectionalLights, false,
       [](Case& c) { c.scene().directional_lights.push_back({}); }},
      {"a sun", Effect::kPointLightShadows, true,
       [](Case& c) {
         row_of(Effect::kDirectionalLights).provoke({c.scene(), c.job, c.spare});
       }},
      {"a sun, no point light", Effect::kPointLights, false,
       [](Case& c) {
         row_of(Effect::kDirectionalLights).provoke({c.scene(), c.job, c.spare});
       }},
      {"a black environment map", Effect::kEnvironment, false,
       [](Case& c) {
         EnvironmentMap map{.name = "", .width = 2, .height = 1, .rgb = std::vector<float>(6)};
         c.scene().environment = std::make_shared<const EnvironmentMap>(map);
       }},
      {"an environment at max_depth 1", Effect::kEmitterSampling, true,
       [](Case& c) {
         row_of(Effect::kEnvironment).provoke({c.scene(), c.job, c.spare});
         c.job.max_depth = 1;
       }},
      {"emission 0", Effect::kAreaEmitters, false,
       [](Case& c) { c.material().emission = Rgb(0.0F); }},
      {"emission seen directly", Effect::kAreaEmitters, true,
       [](Case& c) { c.material().emission = Rgb(1.0F); }},
      {"emission at max_depth 0", Effect::kEmitterSampling, false,
       [](Case& c) { c.material().emission = Rgb(1.0F); }},
      {"emitter sampling off", Effect::kEmitterSampling, false,
       [](Case& c) {
         c.material().emission = Rgb(1.0F);
         c.job = {.emitter_sampling = false};
       }},
      {"a black background", Effect::kBackground, false,
       [](Case& c) { c.scene().background = Rgb(0.0F); }},
      {"diffuse 0", Effect::kDiffuseReflection, false,
       [](Case& c) { c.scene().materials[0].diffuse = Rgb(0.0F); }},
      {"transparent, but specular alone", Effect::kDiffuseTransmission, false, glass(1.5F)},
      {"a matte surface that covers half", Effect::kAlphaCoverage, true,
       [](Case& c) { c.material().coverage = 0.5F; }},
      {"a matte surface that covers all", Effect::kAlphaCoverage, false,
       [](Case& c) { c.material().coverage = 1.0F; }},
      {"a leaf of glTF", Effect::kDiffuseTransmission, true,
       [](Case& c) {
         c.material().model = SurfaceModel::kMicrofacet;
         c.material().facets.diffuse_through = Rgb(0.2F);
       }},
      {"specular 0, whatever the exponent", Effect::kGlossyLobes, false,
       [](Case& c) { c.material().specular_exp = 10.0; }},
      {"a lobe as sharp as a mirror", Effect::kGlossyLobes, false, glass(1.5F)},
      {"a mirror", Effect::kMirrors, true,
       [](Case& c) { c.material() = support::mirror_material(0.9F, 1e10); }},
      {"glass", Effect::kMirrors, false, glass(1.5F)},
      {"glass", Effect::kRefraction, true, glass(1.5F)},
      {"an opaque mirror", Effect::kRefraction, false,
       [](Case& c) { c.material() = support::mirror_material(0.9F, 1e10); }},
      {"glass of index 1.5", Effect::kFresnel, true, glass(1.5F)},
      {"glass of index 1", Effect::kFresnel, false, glass(1.0F)},
      {"glass of index 1 by Schlick's formula", Effect::kFresnel, true,
       [&](Case& c) {
         glass(1.0F)(c);
         c.job.light_model = kSeedModel;
       }},
      {"max_depth 1, no point light", Effect::kIndirectLight, false, depth(1)},
      {"max_depth 2, no point light", Effect::kIndirectLight, true, depth(2)},
      {"max_depth 1, a point light", Effect::kIndirectLight, true,
       [&](Case& c) {
         depth(1)(c);
         light(1.0F)(c);
       }},
      {"max_depth 0, a point light", Effect::kIndirectLight, false, light(1.0F)},
      {"no triangle", Effect::kWatertightTriangles, false,
       [](Case& c) { c.scene().mesh = {}; }},
      {"triangles in a grey sky", Effect::kWatertightTriangles, true, depth(0)},
      {"matte surfaces alone", Effect::kCaustics, false, depth(8)},
      {"matte and mirror", Effect::kCaustics, true,
       [&](Case& c) {
         depth(8)(c);
         c.material() = support::mirror_material(0.9F, 1e10);
       }},
      {"max_depth 3", Effect::kRoulette, false, depth(3)},
      {"max_depth 4", Effect::kRoulette, true, depth(4)},
      {"the seed's model", Effect::kRoulette, false,
       [&](Case& c) {
         depth(8)(c);
         c.job.light_model = kSeedModel;
       }},
  };
  for (const Row& row : rows) {
    Case c;
    row.edit(c);
    EXPECT_EQ(c.calls_for(row.effect), row.called_for) << name(row.effect) << ": " << row.what;
  }
}

/// Normals of the matte box, the same at all corners of a triangle.
void give_normals(Case& c, const std::function<Vec3f(const Vec3f&)>& from_plane) {
  TriangleMesh& mesh = c.scene().mesh;
  for (const auto& corner : mesh.triangles) {
    const Vec3f& p = mesh.positions[corner[0]];
    const auto id = static_cast<std::uint32_t>(mesh.normals.size());
    mesh.normals.push_back(
        from_plane(normalize(cross(mesh.positions[corner[1]] - p, mesh.positions[corner[2]] - p))));
    mesh.corner_normals.push_back({id, id, id});
  }
}

TEST(EffectRows, NormalsThatAreThoseOfThePlaneDoNotCallForInterpolation) {
  Case flat;
  give_normals(flat, [](const Vec3f& ng) { return ng; });
  EXPECT_FALSE(flat.calls_for(Effect::kShadingNormals));
  Case turned;
  give_normals(turned, [](const Vec3f& ng) { return -ng; });
  EXPECT_TRUE(turned.calls_for(Effect::kShadingNormals));
  Case oblique;  // the interpolated normal may differ from the plane's in its last bit
  for (Vec3f& p : oblique.scene().mesh.positions) p = {p.x + 0.3F * p.y, p.y, p.z - 0.2F * p.x};
  give_normals(oblique, [](const Vec3f& ng) { return ng; });
  EXPECT_TRUE(oblique.calls_for(Effect::kShadingNormals));
  Case black = oblique;
  black.scene().materials[0] = {};
  EXPECT_FALSE(black.calls_for(Effect::kShadingNormals));
}

TEST(SceneUse, NormalsThatNothingCallsForAreDropped) {
  Case flat;
  give_normals(flat, [](const Vec3f& ng) { return ng; });
  drop_unused(flat.scene());
  EXPECT_EQ(flat.scene().mesh.normals.capacity(), 0U);
  EXPECT_EQ(flat.scene().mesh.corner_normals.capacity(), 0U);
  Case turned;
  give_normals(turned, [](const Vec3f& ng) { return -ng; });
  const auto kept = turned.scene().mesh.normals;
  drop_unused(turned.scene());
  EXPECT_EQ(turned.scene().mesh.normals, kept);
  EXPECT_EQ(turned.scene().mesh.corner_normals.size(), turned.scene().mesh.triangles.size());
}

TEST(EffectRows, EvidenceNamesWhatDecides) {
  Case c;
  c.material() = support::glass_material(1.5F, 1e10);
  c.material().name = "glass";
  const EffectPlan plan = c.plan();
  const auto evidence = [&](Effect e) { return plan.evidence[static_cast<std::size_t>(e)]; };
  EXPECT_EQ(evidence(Effect::kRefraction), "material `glass`: specular and transparent 1");
  EXPECT_EQ(evidence(Effect::kFresnel), "material `glass`: index of refraction 1.5");
  EXPECT_EQ(evidence(Effect::kPointLights), "no point light has power above 0");
  EXPECT_EQ(evidence(Effect::kBackground), "background 0.5 0.5 0.5");
}

}  // namespace
}  // namespace raykiln::render
