// Pictures with textures: against the same scene without, and closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <future>
#include <thread>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/scene/surface_textures.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::Estimate;
using support::SceneBuilder;

/// The unit square of z = 0 in two triangles, textured from (0, 0) at its upper left corner.
SceneBuilder square_with(const Material& material, TextureImage image, bool emission) {
  SceneBuilder b;
  b.quad({Vec3f(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, b.material(material));
  SurfaceTextures textures;
  textures.images.push_back(std::move(image));
  textures.uv_sets[0].coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  textures.uv_sets[0].corners = {{0, 1, 2}, {0, 2, 3}};
  textures.materials.resize(1);
  TextureUse& use = emission ? textures.materials[0].emission : textures.materials[0].base;
  use.image = 0;
  use.wrap_u = use.wrap_v = TextureWrap::kClamp;
  use.filter = TextureFilter::kNearest;
  b.scene().textures = std::make_shared<const SurfaceTextures>(std::move(textures));
  return b;
}

/// Red, green / blue, white.
TextureImage four() {
  return {.name = "", .width = 2, .height = 2,
          .srgb8 = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}, .linear = {}};
}

RenderSettings square(int side, int depth) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.max_depth = depth;
  return settings;
}

TEST(Textures, ColourIsWhereThePictureHasIt) {
  SceneBuilder b = square_with(diffuse_material(Rgb(0.5F)), four(), false);
  b.scene().background = Rgb(1.0F);
  const std::array<std::pair<Vec3f, Rgbd>, 4> places{{{{0.25F, 0.75F, 0}, {0.5, 0, 0}},
                                                      {{0.75F, 0.75F, 0}, {0, 0.5, 0}},
                                                      {{0.25F, 0.25F, 0}, {0, 0, 0.5}},
                                                      {{0.75F, 0.25F, 0}, {0.5, 0.5, 0.5}}}};
  for (const auto& [place, truth] : places) {
    b.scene().cameras.clear();
    b.camera(place + Vec3f(0.1F, 0.2F, 2.0F), place, {0, 1, 0}, 1e-3);
    const Estimate e = support::estimate(support::render_all(*b.prepare(), square(2, 1), 4));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.mean[c], truth[c], 1e-6);
  }
}

TEST(Textures, AWhiteOneChangesNotABit) {
  SceneBuilder plain = support::mixed_room(), white = support::mixed_room();
  SurfaceTextures textures;
  textures.images.push_back({.name = "", .width = 2, .height = 1,
                             .srgb8 = {255, 255, 255, 255, 255, 255}, .linear = {}});
  textures.uv_sets[1].coordinates = {{0.3F, 0.2F}, {5.0F, 0.1F}, {0.7F, -3.0F}};
  textures.uv_sets[1].corners.assign(white.scene().mesh.triangles.size(), {0, 1, 2});
  for (std::size_t i = 0; i < white.scene().materials.size(); ++i) {
    MaterialTextures used;
    used.base.image = used.emission.image = 0;
    used.base.uv_set = used.emission.uv_set = 1;
    used.specular_tint = Rgb(0.3F);
    textures.materials.push_back(used);
  }
  white.scene().textures = std::make_shared<const SurfaceTextures>(std::move(textures));
  Film a(16, 16), b(16, 16);
  merge(a, support::render_all(*plain.prepare(), square(16, 5), 4));
  merge(b, support::render_all(*white.prepare(), square(16, 5), 4));
  EXPECT_EQ(a.resolve().rgb, b.resolve().rgb);
}

// A square emitter whose picture shines in its upper right quarter alone is a square emitter of that
// quarter, whichever way it is found.
TEST(Textures, AnEmitterIsBrightWhereItsPictureIs) {
  const auto lit = [](SceneBuilder b, bool sampling) {
    b.quad({Vec3f(-4, -4, -1), {4, -4, -1}, {4, 4, -1}, {-4, 4, -1}},
           b.material(diffuse_material(Rgb(0.8F))));
    b.camera({-2, -2, -0.2F}, {0.5F, 0.5F, -1.0F}, {0, 0, 1}, 0.5F);
    RenderSettings settings = square(8, 1);
    settings.emitter_sampling = sampling;
    return support::estimate(support::render_all(*b.prepare(), settings, 512));
  };
  TextureImage quarter = four();
  quarter.srgb8 = {0, 0, 0, 255, 255, 255, 0, 0, 0, 0, 0, 0};
  const Material lamp = diffuse_material(Rgb(0.0F), {6.0F, 3.0F, 1.0F});
  SceneBuilder small;
  small.quad({Vec3f(0.5F, 0.5F, 0), {1, 0.5F, 0}, {1, 1, 0}, {0.5F, 1, 0}}, small.material(lamp));
  const Estimate truth = lit(small, true);
  for (const bool sampling : {true, false}) {
    const Estimate e = lit(square_with(lamp, quarter, true), sampling);
    EXPECT_NEAR(e.mean.x, truth.mean.x, 4.0 * std::hypot(e.standard_error, truth.standard_error) * 3)
        << sampling;
    EXPECT_GT(e.mean.x, 0.01);
    EXPECT_NEAR(e.mean.y / e.mean.x, 0.5, 1e-6);
  }
}

/// Irradiance at `at`, of normal +z, from a polygon of radiance 1 above it (Lambert 1760): half the sum of
/// the angles of its sides times the cosines of their planes with the normal.
double irradiance(const std::vector<Vec3d>& polygon, const Vec3d& at) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d a = normalize(polygon[i] - at);
    const Vec3d b = normalize(polygon[(i + 1) % polygon.size()] - at);
    const Vec3d side = cross(a, b);
    sum += std::atan2(length(side), dot(a, b)) * side.z / length(side);
  }
  return 0.5 * std::abs(sum);
}

// Half black and half white: what the white half sends to a patch below is known, whichever way light is
// found, and the half that is drawn in vain costs noise alone.
TEST(Textures, AHalfWhiteEmitterLightsAPatchAsItsWhiteHalfDoes) {
  TextureImage halves = four();
  halves.height = 1;
  halves.srgb8 = {0, 0, 0, 255, 255, 255};
  const double truth =
      0.5 / kPi * 2.0 *
      irradiance({{0.5, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, 1, 0}}, {0.25, 0.375, -0.5});
  for (const bool sampling : {true, false}) {
    SceneBuilder b = square_with(diffuse_material(Rgb(0.0F), Rgb(2.0F)), halves, true);
    b.quad({Vec3f(-2, -2, -0.5F), {2, -2, -0.5F}, {2, 2, -0.5F}, {-2, 2, -0.5F}},
           b.material(diffuse_material(Rgb(0.5F))));
    b.camera({-0.5F, -0.5F, -0.25F}, {0.25F, 0.375F, -0.5F}, {0, 0, 1}, 1e-3);
    RenderSettings settings = square(8, 1);
    settings.emitter_sampling = sampling;
    const Estimate e = support::estimate(support::render_all(*b.prepare(), settings, 2048));
    EXPECT_NEAR(e.mean.x, truth, 4.0 * e.standard_error) << sampling;
    EXPECT_LT(e.standard_error, 0.01 * truth) << sampling;
  }
}

// A cube of index 1 that absorbs shows exp(-absorption times the way through it) of what is behind.
TEST(Facets, ABodyDimsWhatIsBehindIt) {
  SceneBuilder b;
  Material body;
  body.model = SurfaceModel::kMicrofacet;
  body.transparent = 1.0F;
  body.index_of_refraction = 1.0F;
  body.facets.thin = false;
  body.facets.absorption = {0.0F, 0.5F, 2.0F};
  b.box({-1, -1, -0.75F}, {1, 1, 0.75F}, b.material(body));
  b.scene().background = Rgb(2.0F);
  b.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 1e-3);
  const Estimate e = support::estimate(support::render_all(*b.prepare(), square(2, 4), 4));
  EXPECT_NEAR(e.mean.x, 2.0, 1e-6);
  EXPECT_NEAR(e.mean.y, 2.0 * std::exp(-0.75), 1e-6);
  EXPECT_NEAR(e.mean.z, 2.0 * std::exp(-3.0), 1e-6);
}

// A picture that is black all over makes a dark scene, and nothing that is not finite.
TEST(Textures, ABlackEmitterIsDark) {
  TextureImage black = four();
  black.srgb8.assign(12, 0);
  SceneBuilder b = square_with(diffuse_material(Rgb(0.5F), Rgb(3.0F)), black, true);
  b.camera({0.5F, 0.5F, 2.0F}, {0.5F, 0.5F, 0.0F}, {0, 1, 0}, 0.5F);
  const TileResult result = support::render_all(*b.prepare(), square(4, 3), 4);
  EXPECT_EQ(support::estimate(result).mean, Rgbd(0.0));
  EXPECT_EQ(result.stats.non_finite, 0U);
}

/// A floor with a fine pattern under a lamp and a mirror behind it, seen from `height` above.
SceneBuilder patterned_floor(float height) {
  TextureImage pattern{.name = "", .width = 256, .height = 256, .srgb8 = {}, .linear = {}};
  for (int i = 0; i < 256 * 256; ++i) pattern.srgb8.insert(pattern.srgb8.end(), 3, (i / 256 + i) % 2 == 0 ? 255 : 0);
  SceneBuilder b = square_with(diffuse_material(Rgb(0.8F)), std::move(pattern), false);
  b.quad({Vec3f(0, 1, 0), {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}, b.material(support::mirror_material(0.9F, 1e12)));
  b.point_light({0.5F, 0.5F, 1.0F}, Rgb(1.0F));
  b.camera({0.5F, -0.4F * height, height}, {0.5F, 0.85F, 0.0F}, {0, 0, 1}, 0.2F);
  return b;
}

// Light of a point light is in proportion to what the texture says: nothing but noise is lost, also in a mirror.
TEST(Textures, AFootprintTakesTheNoiseOfAFinePattern) {
  const auto scene = patterned_floor(2.0F).prepare();
  RenderSettings settings = square(24, 1);
  const Estimate exact = support::estimate(support::render_all(*scene, settings, 64));
  settings.texture_reading = TextureReading::kFootprint;
  const Estimate wide = support::estimate(support::render_all(*scene, settings, 64));
  EXPECT_LT(wide.standard_error, 0.25 * exact.standard_error);
  EXPECT_NEAR(wide.mean.x, exact.mean.x, 4.0 * exact.standard_error);
  EXPECT_GT(exact.mean.x, 0.01);
}

using Clock = std::chrono::steady_clock;

double seconds_of(const std::function<void()>& work) {
  const auto begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The first tile makes smaller copies of all textures. Whoever cancels meanwhile does not wait for them, nor
/// do the other workers, who wait for the one that is at it. Against the time of the same copies on the same machine, the best of
/// three turns each: a turn may meet with a busy machine.
TEST(Textures, ACancelIsAnsweredWhileCopiesAreMade) {
  constexpr int kSide = 3000;
  TextureImage large{.name = "", .width = kSide, .height = kSide, .srgb8 = {}, .linear = {}};
  large.srgb8.assign(std::size_t{3} * kSide * kSide, 100);
  SceneBuilder b = square_with(diffuse_material(Rgb(0.8F)), std::move(large), false);
  b.point_light({0.5F, 0.5F, 1.0F}, Rgb(1.0F));
  b.camera({0.5F, 0.5F, 2.0F}, {0.5F, 0.5F, 0.0F}, {0, 1, 0}, 0.5F);
  RenderSettings settings = square(1, 0);
  settings.texture_reading = TextureReading::kFootprint;
  const std::vector<SampleBlock> blocks = blocks_for(1);
  double whole = 1e30, after_stop = 1e30;
  for (int turn = 0; turn < 3; ++turn) {
    whole = std::min(whole, seconds_of([&, scene = b.prepare()] {
                       EXPECT_FALSE(render_tile(*scene, settings, {0, 0, 1, 1}, blocks, {}).stopped);
                     }));
  }
  for (int turn = 0; turn < 3; ++turn) {
    const auto scene = b.prepare();
    std::stop_source source;
    const auto tile = [&] { return render_tile(*scene, settings, {0, 0, 1, 1}, blocks, source.get_token()).stopped; };
    auto one = std::async(std::launch::async, tile), other = std::async(std::launch::async, tile);
    std::this_thread::sleep_for(std::chrono::duration<double>(0.05 * whole));
    bool stopped = false;
    const double seconds = seconds_of([&] {
      source.request_stop();
      stopped = one.get() & other.get();
    });
    if (stopped) after_stop = std::min(after_stop, seconds);
    const auto later = render_tile(*scene, settings, {0, 0, 1, 1}, blocks, {});
    EXPECT_FALSE(later.stopped) << "nothing is left half made";
    EXPECT_NEAR(support::estimate(later).mean.x, support::estimate(render_tile(*b.prepare(), settings, {0, 0, 1, 1}, blocks, {})).mean.x, 0.0);
  }
  EXPECT_LT(after_stop, 0.4 * whole);
}

// Texels wider than pixels are read as they are: no bit differs. Nor where there are no textures.
TEST(Textures, AFootprintSmallerThanATexelChangesNoBit) {
  SceneBuilder near = patterned_floor(2.0F);
  near.scene().cameras.clear();
  near.camera({0.5F, 0.49F, 0.02F}, {0.5F, 0.5F, 0.0F}, {0, 0, 1}, 0.3F);
  for (const auto& scene : {near.prepare(), support::mixed_room().prepare()}) {
    RenderSettings settings = square(16, 0);
    Film exact(16, 16), wide(16, 16);
    merge(exact, support::render_all(*scene, settings, 4));
    settings.texture_reading = TextureReading::kFootprint;
    merge(wide, support::render_all(*scene, settings, 4));
    EXPECT_EQ(exact.resolve().rgb, wide.resolve().rgb);
  }
}

TEST(Textures, AFootprintIsTheSameHoweverTheWorkIsCut) {
  const SceneBuilder b = patterned_floor(1.0F);
  const auto scene = b.prepare();
  RenderSettings settings = square(16, 4);
  settings.texture_reading = TextureReading::kFootprint;
  Film whole(16, 16), parts(16, 16);
  merge(whole, support::render_all(*scene, settings, 8));
  settings.traversal = Traversal::kBruteForce;
  for (int y = 0; y < 16; y += 4) {
    merge(parts, render_tile(*scene, settings, {0, y, 5, y + 4}, blocks_for(8), {}));
    merge(parts, render_tile(*scene, settings, {5, y, 16, y + 4}, blocks_for(8), {}));
  }
  EXPECT_EQ(whole.plane("beauty"), parts.plane("beauty"));
  const auto notices = render_notices(settings, b.scene(), {});
  EXPECT_TRUE(std::any_of(notices.begin(), notices.end(), [](const auto& n) { return n.code == "textures_by_footprint"; }));
}

}  // namespace
}  // namespace raykiln::render
