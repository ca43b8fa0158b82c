// Surfaces that are not there all over: what is seen through them, what lights through them.
#include <gtest/gtest.h>

#include "raykiln/scene/surface_textures.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

using support::diffuse_material;
using support::Estimate;
using support::SceneBuilder;

constexpr std::array<Vec3f, 4> kSquare{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};

Material covering(float coverage, const Rgb& emission) {
  Material material = diffuse_material(Rgb(0.0F), emission);
  material.coverage = coverage;
  return material;
}

/// Gives all triangles of the square's material the picture `alpha` of 2 x 2 texels, from its upper left on.
void cut_out(SceneBuilder& b, std::uint32_t material, const std::vector<std::uint8_t>& alpha,
             std::optional<double> cutoff) {
  SurfaceTextures textures;
  textures.images.push_back(
      {.name = "", .width = 2, .height = 2, .srgb8 = alpha, .linear = {}, .channels = 1});
  textures.uv_sets[0].coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  UvSet& set = textures.uv_sets[0];
  set.corners.resize(b.scene().mesh.triangles.size(), {kNoUv, kNoUv, kNoUv});
  bool second = false;
  for (std::size_t i = 0; i < set.corners.size(); ++i) {
    if (b.scene().mesh.material_ids[i] != material) continue;
    if (second) {
      set.corners[i] = {0, 2, 3};
    } else {
      set.corners[i] = {0, 1, 2};
    }
    second = !second;
  }
  textures.materials.resize(b.scene().materials.size());
  TextureUse& use = textures.materials[material].alpha;
  use.image = 0;
  use.wrap_u = use.wrap_v = TextureWrap::kClamp;
  use.filter = TextureFilter::kNearest;
  textures.materials[material].alpha_cutoff = cutoff;
  b.scene().textures = std::make_shared<const SurfaceTextures>(std::move(textures));
}

TileResult rendered(const SceneBuilder& b, int side, int depth, std::uint64_t samples,
                    bool emitter_sampling = true) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.max_depth = depth;
  settings.emitter_sampling = emitter_sampling;
  return support::render_all(*b.prepare(), settings, samples);
}

TEST(Coverage, AMaskShowsWhatIsBehindItWhereItsPictureIsLow) {
  const std::array<std::pair<Vec3f, double>, 4> places{{{{0.25F, 0.75F, 0}, 0.25},
                                                        {{0.75F, 0.75F, 0}, 3.0},
                                                        {{0.25F, 0.25F, 0}, 3.0},
                                                        {{0.75F, 0.25F, 0}, 0.25}}};
  for (const auto& [place, truth] : places) {
    SceneBuilder b;
    const auto leaf = b.material(covering(0.8F, Rgb(0.25F)));
    b.quad(kSquare, leaf);
    cut_out(b, leaf, {160, 159, 0, 255}, 0.8 * 160.0 / 255.0);
    b.scene().background = Rgb(3.0F);
    b.camera(place + Vec3f(0.1F, 0.2F, 2.0F), place, {0, 1, 0}, 1e-3);
    EXPECT_NEAR(support::estimate(rendered(b, 2, 2, 4)).mean.x, truth, 1e-6) << place.x << place.y;
  }
}

// Squares in one place: the lowest id comes first, and none is missed.
TEST(Coverage, SurfacesInOnePlaceAreMetInTheOrderOfTheirIds) {
  SceneBuilder b;
  for (const float emission : {1.0F, 10.0F, 100.0F}) b.quad(kSquare, b.material(covering(0.5F, Rgb(emission))));
  b.scene().background = Rgb(1000.0F);
  b.camera({0.4F, 0.3F, 2.0F}, {0.4F, 0.3F, 0.0F}, {0, 1, 0}, 1e-3);
  const double truth = 0.5 * 1.0 + 0.25 * 10.0 + 0.125 * 100.0 + 0.125 * 1000.0;
  const Estimate e = support::estimate(rendered(b, 8, 2, 512));
  EXPECT_NEAR(e.mean.x, truth, 4.0 * e.standard_error);
  EXPECT_LT(e.standard_error, 0.02 * truth);
}

// Shadow rays multiply what is let through: no noise.
TEST(Coverage, LightWithoutASurfaceIsDimmedByEveryLayer) {
  const auto lit = [](int layers) {
    SceneBuilder b;
    b.quad({Vec3f(-9, -9, -1), {9, -9, -1}, {9, 9, -1}, {-9, 9, -1}},
           b.material(diffuse_material(Rgb(0.5F))));
    const auto veil = b.material(covering(0.25F, Rgb(0.0F)));
    for (int i = 0; i < layers; ++i) {
      const float z = i < 2 ? 0.5F : 0.75F;  // two of them in one place
      b.quad({Vec3f(-9, -9, z), {9, -9, z}, {9, 9, z}, {-9, 9, z}}, veil);
    }
    b.point_light({0.1F, 0.2F, 2.0F}, Rgb(3.0F));
    b.scene().directional_lights.push_back(
        {.name = "", .direction = normalize(Vec3d(0.1, 0.2, -1)), .irradiance = Rgb(2.0F)});
    b.camera({3, 0, -0.5F}, {0, 0, -1}, {0, 0, 1}, 1e-3);
    return support::estimate(rendered(b, 1, 0, 4)).mean.x;
  };
  const double clear = lit(0);
  EXPECT_GT(clear, 0.1);
  EXPECT_NEAR(lit(3), clear * 0.75 * 0.75 * 0.75, 1e-6 * clear);
}

// A lamp with a hole behind a leaf with a hole lights a floor as the parts that are there do, whichever way
// its light is found.
TEST(Coverage, EmittersShineWhereTheyAreAndThroughWhatIsNot) {
  const auto floor_under = [](SceneBuilder& b) {
    b.quad({Vec3f(-4, -4, -1), {4, -4, -1}, {4, 4, -1}, {-4, 4, -1}},
           b.material(diffuse_material(Rgb(0.8F))));
    b.camera({-2, -2, -0.7F}, {0.5F, 0.5F, -1.0F}, {0, 0, 1}, 0.5F);
  };
  const Rgb light(6.0F);
  SceneBuilder small;
  small.quad({Vec3f(0.5F, 0.5F, 0), {1, 0.5F, 0}, {1, 1, 0}, {0.5F, 1, 0}}, small.material(covering(1.0F, light)));
  const Vec3f below(0, 0, -0.3F);
  const auto black = small.material(covering(1.0F, Rgb(0.0F)));
  small.quad({below, below + Vec3f(1, 0, 0), below + Vec3f(1, 0.5F, 0), below + Vec3f(0, 0.5F, 0)}, black);
  floor_under(small);
  const Estimate truth = support::estimate(rendered(small, 8, 1, 512));
  for (const bool sampling : {true, false}) {
    SceneBuilder b;
    const auto cut = b.material(covering(1.0F, light));
    b.quad(kSquare, cut);
    const auto veil = b.material(covering(0.0F, Rgb(50.0F)));  // is not there, and does not shine
    b.quad({Vec3f(-2, -2, -0.1F), {2, -2, -0.1F}, {2, 2, -0.1F}, {-2, 2, -0.1F}}, veil);
    const auto shade = b.material(covering(1.0F, Rgb(0.0F)));
    b.quad({below, below + Vec3f(1, 0, 0), below + Vec3f(1, 0.5F, 0), below + Vec3f(0, 0.5F, 0)}, shade);
    floor_under(b);
    cut_out(b, cut, {0, 255, 0, 0}, 0.5);
    const Estimate e = support::estimate(rendered(b, 8, 1, 512, sampling));
    EXPECT_NEAR(e.mean.x, truth.mean.x, 4.0 * std::hypot(e.standard_error, truth.standard_error)) << sampling;
    EXPECT_GT(e.mean.x, 0.01);
  }
}

// 1024 surfaces may be passed. What has to pass more brings nothing and is counted as cut off.
TEST(Coverage, ARayThatPassesTooManySurfacesIsTruncated) {
  for (const int layers : {1024, 1025}) {
    SceneBuilder b;
    const auto nothing = b.material(covering(0.0F, Rgb(1.0F)));
    for (int i = 0; i < layers; ++i) b.triangle(kSquare[0], kSquare[1], kSquare[2], nothing);
    b.scene().background = Rgb(2.0F);
    b.camera({0.8F, 0.3F, 2.0F}, {0.8F, 0.3F, 0.0F}, {0, 1, 0}, 1e-3);
    const TileResult result = rendered(b, 1, 2, 2);
    const bool through = layers == 1024;
    EXPECT_EQ(support::estimate(result).mean.x, through ? 2.0 : 0.0);
    EXPECT_EQ(result.stats.truncated, through ? 0U : 2U);
    EXPECT_EQ(result.stats.gap_rays, 2U * 1024U);
  }
}

// The relaunches are the same for every walk, for brute force, and however tasks are cut.
TEST(Coverage, AnyWalkGivesTheSameBytes) {
  SceneBuilder b = support::mixed_room();
  b.scene().background = Rgb(0.2F);
  for (std::size_t i = 0; i < b.scene().materials.size(); ++i) {
    b.scene().materials[i].coverage = i % 2 == 0 ? 0.6F : 1.0F;
  }
  cut_out(b, 1, {0, 255, 130, 40}, std::nullopt);
  RenderSettings settings;
  settings.width = 12;
  settings.height = 10;
  settings.max_depth = 5;
  std::vector<float> first;
  for (const Traversal walk : {Traversal::kBruteForce, Traversal::kScalar, Traversal::kAvx2, Traversal::kAvx512}) {
    settings.traversal = walk;
    Film film(12, 10);
    const TileResult result = support::render_all(*b.prepare(), settings, 3);
    EXPECT_GT(result.stats.gap_rays, 500U);
    merge(film, result);
    if (first.empty()) first = film.resolve().rgb;
    EXPECT_EQ(film.resolve().rgb, first) << static_cast<int>(walk);
  }
}

// A one-sided lamp shines to its front, whichever way it is found, and is not in the way behind it.
TEST(Coverage, AOneSidedSurfaceHasNoBack) {
  const auto floor_lit = [](bool one_sided, bool turned, bool sampling) {
    SceneBuilder b;
    Material lamp = covering(1.0F, Rgb(5.0F));
    lamp.one_sided = one_sided;
    std::array<Vec3f, 4> square = kSquare;
    if (!turned) std::swap(square[1], square[3]);  // faces down
    b.quad(square, b.material(lamp));
    b.quad({Vec3f(-4, -4, -1), {4, -4, -1}, {4, 4, -1}, {-4, 4, -1}}, b.material(diffuse_material(Rgb(0.8F))));
    b.camera({-2, -2, -0.2F}, {0.5F, 0.5F, -1.0F}, {0, 0, 1}, 0.5F);
    if (turned) b.point_light({0.5F, 0.5F, 1.0F}, Rgb(1.0F));  // behind it
    return support::estimate(rendered(b, 8, 1, 256, sampling));
  };
  const Estimate front = floor_lit(false, false, true);
  const double unshaded = floor_lit(true, true, true).mean.x;
  EXPECT_GT(unshaded, 0.01);
  for (const bool sampling : {true, false}) {
    const Estimate e = floor_lit(true, false, sampling);
    EXPECT_NEAR(e.mean.x, front.mean.x, 4.0 * std::hypot(e.standard_error, front.standard_error)) << sampling;
    EXPECT_EQ(floor_lit(true, true, sampling).mean.x, unshaded) << sampling;
  }
}

// Of two squares in one place, turned to either side, each eye sees the one that faces it.
TEST(Coverage, AnEyeSeesFronts) {
  for (const float side : {-2.0F, 2.0F}) {
    SceneBuilder b;
    Material up = covering(1.0F, Rgb(1.0F)), down = covering(1.0F, Rgb(3.0F));
    up.one_sided = down.one_sided = true;
    b.quad(kSquare, b.material(up));
    b.quad({kSquare[0], kSquare[3], kSquare[2], kSquare[1]}, b.material(down));
    b.scene().background = Rgb(9.0F);
    b.camera({0.4F, 0.3F, side}, {0.4F, 0.3F, 0.0F}, {0, 1, 0}, 1e-3);
    EXPECT_EQ(support::estimate(rendered(b, 2, 2, 2)).mean.x, side > 0.0F ? 1.0 : 3.0);
  }
}

// Nothing of a body that covers nothing is left, and nothing that covers all is passed.
TEST(Coverage, NothingAndAllChangeNoBit) {
  const auto picture = [](float coverage, bool with) {
    SceneBuilder b = support::mixed_room();
    b.scene().background = Rgb(0.3F);
    Material ghost = diffuse_material(Rgb(0.5F));
    ghost.coverage = coverage;
    if (with) b.box({-0.5F, -0.5F, 0.1F}, {0.4F, 0.3F, 0.4F}, b.material(ghost));
    Film film(12, 12);
    merge(film, rendered(b, 12, 4, 3));
    return film.resolve().rgb;
  };
  EXPECT_EQ(picture(0.0F, true), picture(0.0F, false));
  EXPECT_NE(picture(1.0F, true), picture(0.0F, false));
}

}  // namespace
}  // namespace raykiln::render
