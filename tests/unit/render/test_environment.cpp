// Pictures lit by an environment map: against the constant background and closed forms.
#include <gtest/gtest.h>

#include "raykiln/render/missing_light.hpp"
#include "raykiln/sampling/warp.hpp"
#include "raykiln/scene/environment_map.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::Estimate;
using support::SceneBuilder;

std::shared_ptr<const EnvironmentMap> constant_map(float radiance) {
  EnvironmentMap map{.name = "", .width = 16, .height = 8, .rgb = {}, .rotation_rad = 0.3};
  map.rgb.assign(3 * 16 * 8, radiance);
  return std::make_shared<const EnvironmentMap>(std::move(map));
}

/// Black but for one texel of an 8 x 4 map in the row above the horizon, over +x: azimuth 0 to 45
/// degrees from +x towards +z, 45 degrees high.
std::shared_ptr<const EnvironmentMap> one_texel(float radiance) {
  EnvironmentMap map{.name = "", .width = 8, .height = 4, .rgb = {}, .rotation_rad = 0.0};
  map.rgb.assign(3 * 8 * 4, 0.0F);
  for (std::size_t c = 0; c < 3; ++c) map.rgb[3 * (8 + 6) + c] = radiance;
  return std::make_shared<const EnvironmentMap>(std::move(map));
}

/// A ball-like box of albedo a in the open: convex, so that nothing but sky lights it.
SceneBuilder box_in_the_open(float albedo) {
  SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(diffuse_material(Rgb(albedo))));
  b.camera({2.0F, 3.0F, 4.0F}, Vec3f(0.0F), {0, 1, 0}, 0.3F);
  return b;
}

RenderSettings square(int side, int depth) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.max_depth = depth;
  return settings;
}

// Every face sees half of the sky of radiance L: it looks like a L, without noise by reflection
// alone, within 4 sigma with samples of the sky as well.
TEST(Environment, FurnaceAroundABox) {
  SceneBuilder b = box_in_the_open(0.6F);
  b.scene().environment = constant_map(0.5F);
  const auto scene = b.prepare();
  for (const bool sampling : {false, true}) {
    for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
      RenderSettings settings = square(8, 2);
      settings.emitter_sampling = sampling;
      settings.light_model = model;
      const TileResult result = support::render_all(*scene, settings, 256);
      const Estimate e = support::estimate(result);
      EXPECT_NEAR(e.mean.y, 0.3, 4.0 * e.standard_error + 1e-6) << sampling << ' ' << name(model);
      EXPECT_EQ(result.stats.non_finite, 0U);
      EXPECT_EQ(result.stats.shadow_rays > 0, sampling);
    }
  }
}

// Where the estimator is the same, so is the picture: a constant map that is not sampled and the
// background of its radiance.
TEST(Environment, AConstantMapIsTheBackground) {
  SceneBuilder map = support::mixed_room(), background = support::mixed_room();
  for (SceneBuilder* b : {&map, &background}) {
    b->scene().mesh.triangles.erase(b->scene().mesh.triangles.begin() + 2,
                                    b->scene().mesh.triangles.begin() + 4);  // no ceiling
    b->scene().mesh.material_ids.erase(b->scene().mesh.material_ids.begin() + 2,
                                       b->scene().mesh.material_ids.begin() + 4);
  }
  map.scene().environment = constant_map(0.75F);
  background.scene().background = Rgb(0.75F);
  RenderSettings settings = square(16, 5);
  settings.emitter_sampling = false;
  const TileResult a = support::render_all(*map.prepare(), settings, 4);
  const TileResult b = support::render_all(*background.prepare(), settings, 4);
  EXPECT_EQ(support::estimate(a).mean, support::estimate(b).mean);
  settings.emitter_sampling = true;
  const Estimate c = support::estimate(support::render_all(*map.prepare(), settings, 256));
  const Estimate d = support::estimate(support::render_all(*background.prepare(), settings, 256));
  EXPECT_NEAR(c.mean.y, d.mean.y, 4.0 * std::hypot(c.standard_error, d.standard_error));
}

TEST(Environment, IsSeenDirectly) {
  SceneBuilder b = box_in_the_open(0.6F);
  b.scene().environment = one_texel(7.0F);
  b.scene().cameras.clear();
  b.camera({9, 9, 9}, {10.0F, 9.5F, 9.4F}, {0, 1, 0}, 1e-3F);  // to the texel
  EXPECT_EQ(support::estimate(support::render_all(*b.prepare(), square(2, 0), 1)).mean, Rgbd(7.0));
  b.scene().cameras.clear();
  b.camera({9, 9, 9}, {8.0F, 9.5F, 9.4F}, {0, 1, 0}, 1e-3F);  // beside
  EXPECT_EQ(support::estimate(support::render_all(*b.prepare(), square(2, 0), 1)).mean, Rgbd(0.0));
}

// E of a floor facing +y from theta 45 to 90 degrees and an eighth of a turn:
// L (pi/4) (sin^2 90 - sin^2 45) / 2 = L pi/16.
TEST(Environment, IrradianceOfOneTexel) {
  SceneBuilder b;
  b.quad({Vec3f(-5, 0, 5), {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}}, b.material(diffuse_material(Rgb(0.8F))));
  b.scene().environment = one_texel(7.0F);
  b.camera({0, 4, 0.5F}, {0, 0, 0.5F}, {0, 0, -1}, 0.5F);
  const double truth = 0.8 / kPi * 7.0 * kPi / 16.0;
  for (const bool sampling : {false, true}) {
    RenderSettings settings = square(8, 1);
    settings.emitter_sampling = sampling;
    const Estimate e = support::estimate(support::render_all(*b.prepare(), settings, 256));
    EXPECT_NEAR(e.mean.x, truth, 4.0 * e.standard_error) << sampling;
    EXPECT_LT(e.standard_error, (sampling ? 0.01 : 0.05) * truth) << sampling;
  }
}

// A sun of one texel in 512 x 256, 1e5 times as bright as the sky: reflection alone does not find
// it in 64 samples, aiming does. E = sky pi + sun * solid angle * cos.
TEST(Environment, ASunIsFound) {
  EnvironmentMap map{.name = "", .width = 512, .height = 256, .rgb = {}, .rotation_rad = 0.0};
  map.rgb.assign(3 * 512 * 256, 0.2F);
  for (std::size_t c = 0; c < 3; ++c) map.rgb[3 * (64 * 512 + 100) + c] = 2e4F;
  SceneBuilder b;
  b.quad({Vec3f(-5, 0, 5), {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}}, b.material(diffuse_material(Rgb(0.5F))));
  b.scene().environment = std::make_shared<const EnvironmentMap>(std::move(map));
  b.camera({0, 4, 0.5F}, {0, 0, 0.5F}, {0, 0, -1}, 0.5F);
  const double top = kPi * 64.0 / 256.0, bottom = kPi * 65.0 / 256.0;
  const double sun = 2e4 - 0.2;
  const double from_sun = sun * 2.0 * kPi / 512.0 * 0.5 *
                          (std::pow(std::sin(bottom), 2) - std::pow(std::sin(top), 2));
  const double truth = 0.5 / kPi * (0.2 * kPi + from_sun);
  const Estimate e = support::estimate(support::render_all(*b.prepare(), square(8, 1), 64));
  EXPECT_NEAR(e.mean.x, truth, 4.0 * e.standard_error);
  // 4096 samples that draw sun or sky; by reflection alone a sample has a relative deviation of 200.
  EXPECT_LT(e.standard_error, 0.02 * truth);
}

// A mirror shows the map: aiming at the map and following the lobe agree for every exponent.
TEST(Environment, EstimatorsAgreeOnGloss) {
  for (const double exponent : {5.0, 300.0, 1e6}) {
    SceneBuilder b;
    b.quad({Vec3f(-5, 0, 5), {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}},
           b.material(support::mirror_material(0.9F, exponent)));
    b.scene().environment = one_texel(7.0F);
    b.camera({-4, 3, -1.5F}, Vec3f(0.0F), {0, 1, 0}, 0.6F);
    std::array<Estimate, 2> e;
    for (const bool sampling : {false, true}) {
      RenderSettings settings = square(8, 1);
      settings.emitter_sampling = sampling;
      e[sampling ? 1U : 0U] = support::estimate(support::render_all(*b.prepare(), settings, 256));
    }
    EXPECT_GT(e[0].mean.x, 0.1);
    EXPECT_NEAR(e[0].mean.x, e[1].mean.x, 4.0 * std::hypot(e[0].standard_error, e[1].standard_error))
        << exponent;
  }
}

// Branches share the light among them, whatever finds it.
TEST(Environment, BranchesAgree) {
  SceneBuilder b = support::mixed_room();
  b.scene().mesh.triangles.resize(b.scene().mesh.triangles.size() - 12);
  b.scene().mesh.material_ids.resize(b.scene().mesh.triangles.size());
  b.scene().mesh.triangles.erase(b.scene().mesh.triangles.begin() + 2,
                                 b.scene().mesh.triangles.begin() + 4);
  b.scene().mesh.material_ids.erase(b.scene().mesh.material_ids.begin() + 2,
                                    b.scene().mesh.material_ids.begin() + 4);
  b.scene().environment = one_texel(7.0F);
  std::vector<Estimate> e;
  for (const int branches : {1, 3}) {
    RenderSettings settings = square(12, 2);
    settings.branches = branches;
    e.push_back(support::estimate(support::render_all(*b.prepare(), settings, 64)));
  }
  EXPECT_NEAR(e[0].mean.y, e[1].mean.y, 4.0 * std::hypot(e[0].standard_error, e[1].standard_error));
}

TEST(Environment, ThatPathsSeldomFindIsAnnounced) {
  EnvironmentMap map{.name = "", .width = 512, .height = 256, .rgb = {}, .rotation_rad = 0.0};
  map.rgb.assign(3 * 512 * 256, 0.0F);
  std::fill_n(map.rgb.begin() + 3 * (512 * 60 + 100), 3, 1e5F);  // 1e-4 sr over the horizon
  support::SceneBuilder b;
  b.triangle({-9, 0, 9}, {9, 0, 9}, {0, 0, -9}, b.material(support::diffuse_material(Rgb(0.5F))));
  b.camera({0, 2, 0.01}, {0, 0, 0}, {0, 1, 0}, 0.6);
  b.scene().environment = std::make_shared<const EnvironmentMap>(std::move(map));
  const auto scene = b.prepare();
  RenderSettings settings;
  settings.width = settings.height = 8;
  settings.max_depth = 2;
  EXPECT_EQ(unseen_light(*scene, settings, 1024).probes, 0U);
  settings.effects.without.insert(Effect::kEmitterSampling);
  EXPECT_GT(unseen_light(*scene, settings, 1024).share(), 0.5);
  settings.effects = {};
  settings.emitter_sampling = false;
  const auto notices = missing_light_notices(*scene, settings);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0].code, "unseen_light");
}

}  // namespace
}  // namespace raykiln::render
