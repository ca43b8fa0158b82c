#include <gtest/gtest.h>

#include <limits>

#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::SceneBuilder;

RenderSettings sized(int width, int height, int depth) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.max_depth = depth;
  return settings;
}

TEST(RenderTile, CallsTheTreeWithManyRaysWhileManyPathsLive) {
  const auto scene = support::mixed_room().prepare();
  for (const int branches : {1, 3}) {
    const std::uint64_t samples = branches == 1 ? 8 : 1;
    RenderSettings settings = sized(64, 64, branches == 1 ? 8 : 3);
    settings.branches = branches;
    const auto blocks = blocks_for(samples);
    const TileResult result = render_tile(*scene, settings, {0, 0, 64, 64}, blocks, {});
    EXPECT_EQ(result.stats.short_calls_while_many_live, 0U);
    EXPECT_EQ(result.stats.paths, samples * 64 * 64);
    EXPECT_EQ(result.stats.camera_rays, result.stats.paths);
    EXPECT_EQ(result.stats.non_finite, 0U);
  }
}

TEST(RenderTile, CountsDoNotDependOnHowTheWorkIsCut) {
  const auto scene = support::mixed_room().prepare();
  const RenderSettings settings = sized(40, 40, 6);
  const auto blocks = blocks_for(4);
  const RenderStats whole = render_tile(*scene, settings, {0, 0, 40, 40}, blocks, {}).stats;
  RenderStats parts;
  for (int y = 0; y < 40; y += 8) {
    for (const SampleBlock& block : blocks) {
      add(parts, render_tile(*scene, settings, {0, y, 40, y + 8}, std::span(&block, 1), {}).stats);
    }
  }
  EXPECT_EQ(parts.camera_rays, whole.camera_rays);
  EXPECT_EQ(parts.bounce_rays, whole.bounce_rays);
  EXPECT_EQ(parts.shadow_rays, whole.shadow_rays);
  EXPECT_EQ(parts.paths, whole.paths);
  EXPECT_EQ(parts.truncated, whole.truncated);
}

TEST(RenderTile, AStopIsAnsweredAndNothingIsMerged) {
  const auto scene = support::mixed_room().prepare();
  std::stop_source source;
  source.request_stop();
  const TileResult result = render_tile(*scene, sized(64, 64, 8), {0, 0, 64, 64}, blocks_for(64),
                                        source.get_token());
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.stats.camera_rays, 0U);
  Film film(64, 64);
  merge(film, result);
  for (const double samples : film.plane("samples")) ASSERT_EQ(samples, 0.0);
}

TEST(RenderTile, BackgroundAloneIsExact) {
  SceneBuilder b;
  b.triangle({0, 0, 5}, {1, 0, 5}, {0, 1, 5}, b.material(diffuse_material(Rgb(0.5F))));
  b.camera(Vec3f(0.0F), {0, 0, -1}, {0, 1, 0}, 0.7F);  // looks away
  b.scene().background = {0.25F, 0.5F, 2.0F};
  const TileResult result = support::render_all(*b.prepare(), sized(5, 3, 4), 4);
  Film film(5, 3);
  merge(film, result);
  const Image image = film.resolve();
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_EQ(image.rgb[3 * i], 0.25F);
    EXPECT_EQ(image.rgb[3 * i + 2], 2.0F);
  }
  EXPECT_EQ(result.stats.bounce_rays + result.stats.shadow_rays, 0U);
}

// A step edge at x = 2.25 pixels, rows counted from the top.
TEST(RenderTile, PixelsLieWhereTheCameraSays) {
  SceneBuilder b;
  const auto lamp = b.material(diffuse_material(Rgb(0.0F), Rgb(1.0F)));
  // Field of view 90 degrees, 4x4 pixels, plane at distance 2: a pixel is one unit wide.
  b.quad({Vec3f(-2, 1, -2), {0.25F, 1, -2}, {0.25F, 2, -2}, {-2, 2, -2}}, lamp);
  b.camera(Vec3f(0.0F), {0, 0, -1}, {0, 1, 0}, 1.57079633F);
  const auto scene = b.prepare();
  RenderSettings settings = sized(4, 4, 0);
  Film random(4, 4), centre(4, 4);
  merge(random, support::render_all(*scene, settings, 4096));
  settings.pixel_mode = PixelMode::kCentre;
  merge(centre, support::render_all(*scene, settings, 1));
  const Image r = random.resolve(), c = centre.resolve();
  EXPECT_EQ(r.rgb[0], 1.0F);
  EXPECT_EQ(c.rgb[3], 1.0F);
  EXPECT_NEAR(r.rgb[6], 0.25F, 4.0 * std::sqrt(0.1875 / 4096));  // 4 sigma: 6e-5
  EXPECT_EQ(c.rgb[6], 0.0F);
  EXPECT_EQ(r.rgb[9], 0.0F);
  EXPECT_EQ(r.rgb[12], 0.0F);  // second row: below the lamp
}

TEST(RenderTile, OddShapesAreSampledExactly) {
  const auto scene = support::mixed_room().prepare();
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 300}, {300, 1}, {3, 3}}) {
    Film film(w, h);
    merge(film, support::render_all(*scene, sized(w, h, 2), 5));
    for (const double samples : film.plane("samples")) ASSERT_EQ(samples, 5.0);
  }
  EXPECT_TRUE(render_tile(*scene, sized(4, 4, 1), {2, 2, 2, 2}, blocks_for(1), {}).blocks.size() == 1);
  EXPECT_TRUE(render_tile(*scene, sized(4, 4, 1), {0, 0, 4, 4}, {}, {}).blocks.empty());
}

TEST(RenderTile, AnEmptySceneRenders) {
  SceneBuilder b;
  b.camera(Vec3f(0.0F), {0, 0, -1}, {0, 1, 0}, 1.0F);
  b.scene().background = Rgb(0.5F);
  EXPECT_DOUBLE_EQ(support::estimate(support::render_all(*b.prepare(), sized(4, 4, 3), 2)).mean.x, 0.5);
}

// Two mirrors that double what they show, a lamp near the end of the format: sums overflow float.
TEST(RenderTile, NonFiniteSamplesAreCountedAndLocated) {
  SceneBuilder b;
  const auto lamp = b.material(diffuse_material(Rgb(0.9F), Rgb(1e38F)));
  b.box(Vec3f(-1.0F), Vec3f(1.0F), lamp, true);
  b.box(Vec3f(-0.2F), Vec3f(0.2F), b.material(support::mirror_material(1.0F, 1e15)));
  b.camera({0, 0, 0.9F}, {0, 0, -1}, {0, 1, 0}, 1.0F);
  const TileResult result = support::render_all(*b.prepare(), sized(8, 8, 30), 4);
  EXPECT_GT(result.stats.non_finite, 0U);
  ASSERT_FALSE(result.bad_samples.empty());
  EXPECT_LE(result.bad_samples.size(), 16U);
  Film film(8, 8);
  merge(film, result);
  double dropped = 0.0, kept = 0.0;
  for (const double n : film.plane("inf")) dropped += n;
  for (const double n : film.plane("nan")) dropped += n;
  for (const double n : film.plane("samples")) kept += n;
  EXPECT_EQ(dropped, static_cast<double>(result.stats.non_finite));
  EXPECT_EQ(dropped + kept, 4.0 * 64);
  for (const float value : film.resolve().rgb) ASSERT_TRUE(std::isfinite(value));
  // The located sample alone is bad again.
  const BadSample bad = result.bad_samples.front();
  const SampleBlock one{.index = 0, .first = bad.sample, .count = 1, .complete = true};
  const TileResult again = render_tile(*b.prepare(), sized(8, 8, 30),
                                       {bad.x, bad.y, bad.x + 1, bad.y + 1}, std::span(&one, 1), {});
  EXPECT_EQ(again.stats.non_finite, 1U);
}

TEST(RenderTile, LightTrappedInGlassEndsAtTheDepthLimit) {
  SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(support::glass_material(1.5F, 1e12)));
  b.camera(Vec3f(0.0F), {1, 1, 1}, {0, 1, 0}, 0.01F);
  b.scene().background = Rgb(1.0F);
  const TileResult result = support::render_all(*b.prepare(), sized(4, 4, 60), 16);
  EXPECT_EQ(result.stats.truncated, result.stats.paths);
  EXPECT_EQ(support::estimate(result).mean.x, 0.0);
}

TEST(RenderTile, LinearInLightBitForBit) {
  const auto render = [](int k) {
    SceneBuilder b = support::mixed_room();
    const float scale = std::ldexp(1.0F, k);
    for (Material& m : b.scene().materials) m.emission *= scale;
    for (PointLight& l : b.scene().point_lights) l.intensity *= scale;
    Film film(16, 16);
    merge(film, support::render_all(*b.prepare(), sized(16, 16, 4), 4));
    return film.plane("beauty");
  };
  const auto one = render(0);
  for (const int k : {-40, -3, 40}) {
    const auto scaled = render(k);
    for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(scaled[i], std::ldexp(one[i], k));
  }
}

TEST(RenderTile, ScaledByAPowerOfTwoIsTheSamePicture) {
  const auto render = [](int k) {
    SceneBuilder b = support::mixed_room();
    const float scale = std::ldexp(1.0F, k);
    for (Vec3f& p : b.scene().mesh.positions) p *= scale;
    b.scene().bounds.lo *= scale;
    b.scene().bounds.hi *= scale;
    b.scene().cameras[0].eye *= static_cast<double>(scale);
    for (PointLight& l : b.scene().point_lights) {
      l.position *= scale;
      l.intensity *= scale * scale;
    }
    Film film(16, 16);
    merge(film, support::render_all(*b.prepare(), sized(16, 16, 4), 4));
    return film.plane("beauty");
  };
  const auto one = render(0);
  for (const int k : {-30, -10, 10, 30}) EXPECT_EQ(render(k), one) << k;
}

TEST(RenderTile, ChannelsPermuteBitForBit) {
  const auto render = [](bool turned) {
    SceneBuilder b = support::mixed_room();
    const auto turn = [&](Rgb& c) {
      if (turned) c = {c.y, c.z, c.x};
    };
    for (Material& m : b.scene().materials) turn(m.diffuse), turn(m.specular), turn(m.emission);
    for (PointLight& l : b.scene().point_lights) turn(l.intensity);
    Film film(16, 16);
    merge(film, support::render_all(*b.prepare(), sized(16, 16, 4), 4));
    return film.plane("beauty");
  };
  const auto plain = render(false), turned = render(true);
  for (std::size_t i = 0; i < plain.size(); i += 3) {
    ASSERT_EQ(turned[i], plain[i + 1]);
    ASSERT_EQ(turned[i + 1], plain[i + 2]);
    ASSERT_EQ(turned[i + 2], plain[i]);
  }
}

}  // namespace
}  // namespace raykiln::render
