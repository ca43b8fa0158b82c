#include <gtest/gtest.h>

#include <cmath>
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

// A window is a piece of the whole, bit for bit, whatever the filter, the sampler and the lens.
TEST(RenderTile, ACropWindowHasThePixelsOfTheWholePicture) {
  SceneBuilder room = support::mixed_room();
  for (const double radius : {0.0, 0.03}) {
    room.scene().cameras[0].lens = {.radius = radius, .focus_distance = 1.2};
    const auto scene = room.prepare();
    RenderSettings settings = sized(24, 20, 4);
    settings.pixel_filter = radius > 0.0 ? PixelFilter::kBlackmanHarris : PixelFilter::kBox;
    settings.sampler = radius > 0.0 ? Sampler::kSobol : Sampler::kRandom;
    Film whole = make_film(settings);
    merge(whole, support::render_all(*scene, settings, 4));
    settings.width = 9;
    settings.height = 6;
    settings.crop = Crop{.x = 11, .y = 7, .full_width = 24, .full_height = 20};
    ASSERT_FALSE(settings_error(settings, room.scene()));
    Film window = make_film(settings);
    merge(window, support::render_all(*scene, settings, 4));
    const auto all = whole.plane("beauty"), part = window.plane("beauty");
    for (std::size_t y = 0; y < 6; ++y) {
      for (std::size_t x = 0; x < 9 * 3; ++x) {
        ASSERT_EQ(part[y * 27 + x], all[(y + 7) * 72 + 33 + x]) << x / 3 << ' ' << y;
      }
    }
  }
  RenderSettings outside = sized(9, 6, 1);
  outside.crop = Crop{.x = 16, .y = 0, .full_width = 24, .full_height = 20};
  EXPECT_TRUE(settings_error(outside, room.scene()));
}

// A square of side s and radiance L at depth z before a lens of radius R focused at f fills a disk of the
// radius R |z/f - 1| with s^2 L / (pi R^2 (z/f - 1)^2); without the lens it is one bright pixel.
TEST(RenderTile, AnEmitterOutOfFocusIsADiskOfItsLight) {
  constexpr double kSide = 0.02, kLight = 1e3, kRadius = 0.1, kFocus = 2.0, kDepth = 4.0;
  SceneBuilder b;
  const auto h = static_cast<float>(0.5 * kSide);
  const auto z = static_cast<float>(-kDepth);
  b.quad({Vec3f(-h, -h, z), {h, -h, z}, {h, h, z}, {-h, h, z}},
         b.material(diffuse_material(Rgb(0.0F), Rgb(static_cast<float>(kLight)))));
  b.camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.2);
  b.scene().cameras[0].lens = {.radius = kRadius, .focus_distance = kFocus};
  const auto scene = b.prepare();
  RenderSettings settings = sized(24, 24, 0);
  const double pixel = 2.0 * kFocus * std::tan(0.1) / 24.0;  // in the plane of focus
  // There a ray to the point at depth z passes at R (1 - f/z) at most from the axis.
  const double blur = kRadius * (1.0 - kFocus / kDepth) / pixel;
  const double share = kSide / (kRadius * (kDepth / kFocus - 1.0));
  const double radiance = kLight * share * share / 3.14159265358979;
  const auto picture = [&] {
    Film film = make_film(settings);
    merge(film, support::render_all(*scene, settings, 1024));
    return film;
  };
  const Film film = picture();
  const auto beauty = film.plane("beauty"), moments = film.plane("luminance_moment");
  double mean = 0.0, variance = 0.0, inside = 0.0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const auto i = static_cast<std::size_t>(24 * y + x);
      const double far = std::hypot(x - 11.5, y - 11.5);
      if (far > blur + 1.5) {
        EXPECT_EQ(beauty[3 * i], 0.0) << x << ' ' << y;
      }
      if (far > blur - 1.0) continue;
      inside += 1.0;
      mean += beauty[3 * i] / 1024.0;
      variance += moments[i] / 1024.0 / 1024.0;
    }
  }
  EXPECT_EQ(inside, 12.0);
  EXPECT_NEAR(mean / inside, radiance, 4.0 * std::sqrt(variance) / inside + 1e-3 * radiance);

  settings.effects.without = {Effect::kDepthOfField};
  const Film sharp = picture();
  settings.effects.without = {};
  b.scene().cameras[0].lens.radius = 0.0;
  const auto pinhole = b.prepare();
  Film same = make_film(settings);
  merge(same, support::render_all(*pinhole, settings, 1024));
  EXPECT_EQ(sharp.plane("beauty"), same.plane("beauty"));
  EXPECT_EQ(sharp.plane("beauty").front(), 0.0);
}

}  // namespace
}  // namespace raykiln::render
