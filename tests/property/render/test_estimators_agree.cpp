// Different ways to estimate the same light have the same mean.
#include <gtest/gtest.h>

#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::Estimate;
using support::SceneBuilder;

/// A room with a lamp, glossy, rough glass and translucent pieces; nothing too sharp for uniform
/// directions to find.
SceneBuilder soft_room() {
  SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(diffuse_material({0.6F, 0.5F, 0.4F})), true);
  const auto lamp = b.material(diffuse_material(Rgb(0.2F), Rgb(3.0F)));
  b.quad({Vec3f(-0.6F, 0.95F, -0.6F), {0.6F, 0.95F, -0.6F}, {0.6F, 0.95F, 0.6F}, {-0.6F, 0.95F, 0.6F}}, lamp);
  Material gloss = support::mirror_material(0.4F, 6.0);
  gloss.diffuse = Rgb(0.3F);
  b.box({-0.7F, -0.9F, -0.6F}, {-0.1F, -0.2F, 0.0F}, b.material(gloss));
  b.box({0.1F, -0.8F, -0.4F}, {0.6F, -0.3F, 0.2F}, b.material(support::glass_material(1.3F, 8.0)));
  Material leaf = diffuse_material(Rgb(0.8F));
  leaf.transparent = 1.0F;
  b.quad({Vec3f(-0.5F, 0.3F, -0.7F), {0.5F, 0.3F, -0.7F}, {0.5F, 0.4F, 0.0F}, {-0.5F, 0.4F, 0.0F}},
         b.material(leaf));
  b.camera({0, 0, 0.9F}, {0, -0.3F, -1}, {0, 1, 0}, 1.2F);
  return b;
}

RenderSettings base() {
  RenderSettings settings;
  settings.width = settings.height = 16;
  settings.max_depth = 3;
  return settings;
}

// 4 pairs at 4 sigma of the difference: false alarm 2.5e-4.
TEST(EstimatorsAgree, OnTheMeanOfASmallRoom) {
  const auto scene = soft_room().prepare();
  const auto render = [&](auto change, std::uint64_t samples) {
    RenderSettings settings = base();
    change(settings);
    return support::estimate(support::render_all(*scene, settings, samples));
  };
  const Estimate mixed = render([](auto&) {}, 512);
  const Estimate bsdf = render([](auto& s) { s.emitter_sampling = false, s.seed = 1; }, 1024);
  const Estimate branches = render([](auto& s) { s.branches = 3, s.seed = 2; }, 64);
  const Estimate sphere = render(
      [](auto& s) { s.direction_sampling = DirectionSampling::kUniformSphere, s.seed = 3; }, 512);
  const Estimate plain = render(
      [](auto& s) {
        s.direction_sampling = DirectionSampling::kUniformSphere;
        s.emitter_sampling = false;
        s.seed = 4;
      },
      2048);
  const auto expect_agree = [&](const Estimate& other, const char* what) {
    const double sigma = std::hypot(mixed.standard_error, other.standard_error);
    EXPECT_NEAR(luminance(mixed.mean), luminance(other.mean), 4.0 * sigma)
        << what << ", errors " << mixed.standard_error << ' ' << other.standard_error;
    EXPECT_LT(sigma, 0.02 * luminance(mixed.mean)) << what << ": too noisy to say anything";
  };
  expect_agree(bsdf, "without emitter sampling");
  expect_agree(branches, "three rays at each hit");
  expect_agree(sphere, "uniform directions and emitters");
  expect_agree(plain, "uniform directions alone");
}

// Roulette changes the noise and nothing else, with branches, inside glass and with every switch of
// the light model. 4 pairs at 4 sigma of the difference: false alarm 2.5e-4.
TEST(EstimatorsAgree, WithAndWithoutRoulette) {
  const auto scene = soft_room().prepare();
  for (const auto& [branches, samples] : {std::pair{1, 256}, {2, 32}}) {
    for (LightModel model : {kPhysicalModel, kSeedModel}) {
      RenderSettings settings = base();
      settings.max_depth = branches == 1 ? 12 : 5;
      settings.branches = branches;
      settings.light_model = model;
      settings.light_model.roulette = false;
      const Estimate fixed =
          support::estimate(support::render_all(*scene, settings, static_cast<std::uint64_t>(samples)));
      settings.seed = 1;
      settings.light_model.roulette = true;
      const Estimate random =
          support::estimate(support::render_all(*scene, settings, static_cast<std::uint64_t>(samples)));
      EXPECT_NEAR(fixed.mean.y, random.mean.y,
                  4.0 * std::hypot(fixed.standard_error, random.standard_error))
          << name(model) << ' ' << branches;
    }
  }
}

// Emitter sampling is there for small lamps: less variance at equal samples.
TEST(EstimatorsAgree, EmitterSamplingTamesASmallLamp) {
  SceneBuilder b;
  b.quad({Vec3f(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, b.material(diffuse_material(Rgb(0.8F))));
  b.quad({Vec3f(-0.05F, -0.05F, 1), {-0.05F, 0.05F, 1}, {0.05F, 0.05F, 1}, {0.05F, -0.05F, 1}},
         b.material(diffuse_material(Rgb(0.0F), Rgb(100.0F))));
  b.camera({0, 0, 0.9F}, Vec3f(0.0F), {0, 1, 0}, 0.9F);
  const auto scene = b.prepare();
  RenderSettings settings = base();
  const Estimate with = support::estimate(support::render_all(*scene, settings, 64));
  settings.emitter_sampling = false;
  const Estimate without = support::estimate(support::render_all(*scene, settings, 64));
  EXPECT_LT(with.standard_error, 0.1 * without.standard_error);
}

/// The soft room with 300 lamps of all sizes in its upper half, which the camera does not see: lamps smaller
/// than a pixel are noise that no choice among them cures. Two of three may shine to their fronts alone.
std::shared_ptr<const PreparedScene> room_of_lamps(bool fronts = false) {
  SceneBuilder b = soft_room();
  const auto number = [](std::uint64_t i, std::uint64_t what) {
    return static_cast<float>(uniform(vertex_key(path_key(9, i, what), 0, 0), Dimension::kLightU));
  };
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vec3f at(1.8F * number(i, 0) - 0.9F, 0.9F * number(i, 1), 1.8F * number(i, 2) - 0.9F);
    const float size = 0.002F + 0.05F * number(i, 3) * number(i, 3);
    const Vec3f up(0, size * number(i, 4), size), aside(size, size * number(i, 5), 0);
    Material lamp = diffuse_material(Rgb(0.1F), Rgb(0.02F / (size * size)));
    lamp.one_sided = fronts && i % 3 != 0;
    b.triangle(at, at + aside, at + up, b.material(lamp));
  }
  b.look({0, -0.1, 0.9}, {0, -1, -0.3}, {0, 1, 0}, 0.8);
  return b.prepare();
}

// 3 pairs at 4 sigma of the difference: false alarm 1.9e-4.
TEST(EstimatorsAgree, HoweverEmittersAreChosen) {
  const auto scene = room_of_lamps();
  const auto render = [&](auto change, std::uint64_t samples) {
    RenderSettings settings = base();
    change(settings);
    return support::estimate(support::render_all(*scene, settings, samples));
  };
  const Estimate tree = render([](auto& s) { s.emitter_choice = EmitterChoice::kTree; }, 256);
  const Estimate power = render([](auto& s) { s.emitter_choice = EmitterChoice::kPower, s.seed = 1; }, 256);
  const Estimate branches = render([](auto& s) { s.branches = 2, s.seed = 2; }, 128);
  const Estimate sobol = render([](auto& s) { s.sampler = Sampler::kSobol, s.seed = 3; }, 256);
  for (const Estimate& other : {power, branches, sobol}) {
    const double sigma = std::hypot(tree.standard_error, other.standard_error);
    EXPECT_NEAR(luminance(tree.mean), luminance(other.mean), 4.0 * sigma) << tree.standard_error;
    EXPECT_LT(sigma, 0.03 * luminance(tree.mean)) << "too noisy to say anything";
  }
  EXPECT_LT(tree.standard_error, power.standard_error);
}

// What the tree does not draw because it faces the other way brings nothing; nor what it would have drawn.
TEST(EstimatorsAgree, WhereLampsShineToTheirFronts) {
  const auto scene = room_of_lamps(true);
  const auto render = [&](auto change) {
    RenderSettings settings = base();
    change(settings);
    return support::estimate(support::render_all(*scene, settings, 256));
  };
  const Estimate tree = render([](auto&) {});
  const Estimate power = render([](auto& s) { s.emitter_choice = EmitterChoice::kPower, s.seed = 1; });
  const double sigma = std::hypot(tree.standard_error, power.standard_error);
  EXPECT_NEAR(luminance(tree.mean), luminance(power.mean), 4.0 * sigma) << tree.standard_error;
  EXPECT_LT(sigma, 0.03 * luminance(tree.mean)) << "too noisy to say anything";
  EXPECT_LT(tree.standard_error, power.standard_error);
}

// A draw from the tree, too, is a function of the path alone.
TEST(EstimatorsAgree, TheTreeGivesTheSameBytesHoweverTheWorkIsCut) {
  const auto scene = room_of_lamps();
  RenderSettings settings = base();
  const TileResult whole = support::render_all(*scene, settings, 8);
  settings.traversal = Traversal::kBruteForce;
  const auto blocks = blocks_for(8);
  Film one(16, 16), parts(16, 16);
  merge(one, whole);
  for (int y = 0; y < 16; y += 4) {
    merge(parts, render_tile(*scene, settings, {0, y, 5, y + 4}, blocks, {}));
    merge(parts, render_tile(*scene, settings, {5, y, 16, y + 4}, blocks, {}));
  }
  for (const char* plane : {"beauty", "luminance_moment"}) EXPECT_EQ(one.plane(plane), parts.plane(plane)) << plane;
}

}  // namespace
}  // namespace raykiln::render
