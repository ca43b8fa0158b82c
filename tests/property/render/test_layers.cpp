// Layers beside the picture: what they hold, that the parts of light add up to it, and that they change nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/effect_rooms.hpp"

namespace raykiln::render {
namespace {

LayerSet all_layers() { return *layer_set_of("albedo,normal,depth,object_id,material_id,emission,direct,indirect"); }

struct Made {
  Film film;
  LayerFilm layers;
  std::vector<float> samples;
  std::vector<float> operator[](Layer layer) const { return layers.resolve(layer, samples); }
};

/// In bands of `rows` rows, the last one first, and in tasks of so many blocks.
Made made_of(const PreparedScene& scene, const RenderSettings& settings, std::span<const SampleBlock> blocks,
             int rows = 1000, std::size_t blocks_a_task = 1000) {
  Made made{make_film(settings), LayerFilm(settings.layers, settings.width, settings.height), {}};
  for (int y = (settings.height - 1) / rows * rows; y >= 0; y -= rows) {
    for (std::size_t first = 0; first < blocks.size(); first += blocks_a_task) {
      const auto some = blocks.subspan(first, std::min(blocks_a_task, blocks.size() - first));
      const PixelRect band{0, y, settings.width, std::min(y + rows, settings.height)};
      const TileResult result = render_tile(scene, settings, band, some, {});
      merge(made.film, result);
      merge(made.layers, result);
    }
  }
  for (const double n : made.film.plane("samples")) made.samples.push_back(static_cast<float>(n));
  return made;
}

bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

void expect_same(const Made& a, const Made& b, const std::string& what) {
  for (const PlaneSpec& plane : film_planes()) EXPECT_EQ(a.film.plane(plane.name), b.film.plane(plane.name)) << what;
  for (const Layer layer : layers_in(a.layers.set())) EXPECT_TRUE(same_bytes(a[layer], b[layer])) << spec(layer).name << ' ' << what;
}

/// A square of 2 x 2 m, 2 m before the camera, over the left half of the picture; the rest is background.
class Square : public testing::Test {
 protected:
  Square() {
    builder_.material(support::diffuse_material(Rgb(0.5F)));
    const auto paint = builder_.material(support::diffuse_material({0.25F, 0.5F, 0.75F}, Rgb(2.0F)));
    builder_.quad({Vec3f(-2, -2, -2), {0, -2, -2}, {0, 2, -2}, {-2, 2, -2}}, paint);
    builder_.camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0F);
    builder_.scene().background = Rgb(0.125F);
    builder_.scene().mesh.objects = {{0, 3}};
    settings_.width = 8;
    settings_.height = 6;
    settings_.layers = all_layers();
  }
  [[nodiscard]] Made made(std::uint64_t samples) { return made_of(*builder_.prepare(), settings_, blocks_for(samples)); }
  support::SceneBuilder builder_;
  RenderSettings settings_;
};

TEST_F(Square, IsWhatItIs) {
  const Made m = made(5);
  const std::size_t left = 8 * 2 + 1, right = left + 5;
  const float dark = 0.0F;
  EXPECT_EQ(m[Layer::kAlbedo][3 * left], 0.25F);
  EXPECT_EQ(m[Layer::kAlbedo][3 * left + 2], 0.75F);
  EXPECT_EQ(m[Layer::kAlbedo][3 * right], dark);
  EXPECT_EQ(m[Layer::kNormal][3 * left + 2], 1.0F);
  EXPECT_EQ(m[Layer::kNormal][3 * right + 2], dark);
  // Along the axis, so that a plane before the camera has one depth.
  EXPECT_NEAR(m[Layer::kDepth][left], 2.0F, 1e-6F);
  EXPECT_NEAR(m[Layer::kDepth][0], 2.0F, 1e-6F);
  EXPECT_EQ(m[Layer::kDepth][right], std::numeric_limits<float>::infinity());
  EXPECT_EQ(m[Layer::kObjectId][left], 4.0F);
  EXPECT_EQ(m[Layer::kMaterialId][left], 2.0F);
  EXPECT_EQ(m[Layer::kObjectId][right], dark);
  EXPECT_EQ(m[Layer::kMaterialId][right], dark);
  EXPECT_EQ(m[Layer::kEmission][3 * left], 2.0F);
  EXPECT_EQ(m[Layer::kEmission][3 * right], 0.125F);
  EXPECT_EQ(m[Layer::kDirect][3 * right], dark);
}

// Light that goes through to the far side is no less the surface's own than what comes back.
TEST_F(Square, AlbedoIsOfBothWaysThatLightGoesOn) {
  Material& leaf = builder_.scene().materials[1];
  leaf.model = SurfaceModel::kMicrofacet;
  leaf.diffuse = {0.125F, 0.25F, 0.0F};
  leaf.facets.diffuse_through = {0.5F, 0.25F, 0.0F};
  for (const float clear : {0.0F, 0.5F}) {
    leaf.transparent = clear;
    leaf.facets.tint = Rgb(0.25F);
    const auto albedo = made(1)[Layer::kAlbedo];
    const float base = 1.0F - clear, through = 0.25F * clear;
    EXPECT_EQ(albedo[3 * 17], 0.625F * base + through);
    EXPECT_EQ(albedo[3 * 17 + 1], 0.5F * base + through);
    EXPECT_EQ(albedo[3 * 17 + 2], through);
  }
}

TEST_F(Square, IsTurnedToTheCameraFromBehindToo) {
  std::reverse(builder_.scene().mesh.triangles[0].begin(), builder_.scene().mesh.triangles[0].end());
  std::reverse(builder_.scene().mesh.triangles[1].begin(), builder_.scene().mesh.triangles[1].end());
  EXPECT_EQ(made(1)[Layer::kNormal][3 * 17 + 2], 1.0F);
}

// The edge runs between the columns 3 and 4 with a lens: pixels there meet it with some of their samples.
TEST_F(Square, WhereSomeSamplesMeetItDepthIsOfThose) {
  builder_.scene().cameras[0].lens = {0.2, 10.0};
  const Made m = made(64);
  const auto albedo = m[Layer::kAlbedo], depth = m[Layer::kDepth];
  std::size_t mixed = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!(albedo[3 * i] > 0.0F && albedo[3 * i] < 0.25F)) continue;
    ++mixed;
    EXPECT_NEAR(depth[i], 2.0F, 1e-6F);
  }
  EXPECT_GT(mixed, 4U);
}

TEST_F(Square, InTheDarkIsThereAllTheSame) {
  builder_.scene().materials[1].emission = Rgb(0.0F);
  builder_.scene().background = Rgb(0.0F);
  const Made m = made(2);
  EXPECT_EQ(m.film.plane("beauty"), std::vector<double>(3 * 48));
  EXPECT_EQ(m[Layer::kAlbedo][3 * 17 + 1], 0.5F);
  EXPECT_EQ(m[Layer::kMaterialId][17], 2.0F);
  EXPECT_EQ(m[Layer::kDepth][22], std::numeric_limits<float>::infinity());
}

TEST_F(Square, NothingButABackgroundIsEmission) {
  builder_.scene().mesh = {};
  const Made m = made(2);
  EXPECT_EQ(m[Layer::kEmission][0], 0.125F);
  EXPECT_EQ(m[Layer::kMaterialId][0], 0.0F);
}

TEST_F(Square, UnderAPointLightIsLitDirectlyAlone) {
  builder_.scene().materials[1].emission = Rgb(0.0F);
  builder_.scene().background = Rgb(0.0F);
  builder_.point_light({0, 0, 0}, Rgb(4.0F));
  for (const bool shadows : {true, false}) {
    if (!shadows) settings_.effects.without.insert(Effect::kPointLightShadows);
    const Made m = made(3);
    EXPECT_GT(m[Layer::kDirect][3 * 17], 0.0F);
    EXPECT_TRUE(same_bytes(m[Layer::kDirect], m.film.resolve().rgb)) << shadows;
    EXPECT_EQ(m[Layer::kEmission], std::vector<float>(3 * 48)) << shadows;
    EXPECT_EQ(m[Layer::kIndirect], std::vector<float>(3 * 48)) << shadows;
  }
}

// The picture is the same bytes, and no more rays are traced.
void expect_beside(const support::EffectScene& s, std::uint64_t samples) {
  support::SceneBuilder builder = s.builder;
  const auto scene = builder.prepare();
  RenderSettings with = s.settings;
  with.layers = all_layers();
  const PixelRect whole{0, 0, with.width, with.height};
  const auto blocks = blocks_for(samples);
  const TileResult plain = render_tile(*scene, s.settings, whole, blocks, {});
  const TileResult layered = render_tile(*scene, with, whole, blocks, {});
  ASSERT_EQ(layered.layers.size(), blocks.size());
  EXPECT_TRUE(plain.layers.empty());
  EXPECT_EQ(plain.stats.bounce_rays, layered.stats.bounce_rays) << s.name;
  EXPECT_EQ(plain.stats.shadow_rays, layered.stats.shadow_rays) << s.name;
  const LayerSet light = *layer_set_of("emission,direct,indirect");
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    EXPECT_EQ(plain.blocks[b].planes.planes, layered.blocks[b].planes.planes) << s.name;
    const auto& beauty = layered.blocks[b].planes.planes[BlockPlane::kBeauty];
    const std::size_t stride = sums_of(with.layers), first = stride - sums_of(light);
    for (std::size_t i = 0; i < beauty.size(); ++i) {
      const double* parts = &layered.layers[b].sums[stride * (i / 3) + first + i % 3];
      const double sum = parts[0] + parts[3] + parts[6];
      ASSERT_NEAR(sum, beauty[i], 1e-12 * (std::abs(parts[0]) + std::abs(parts[3]) + std::abs(parts[6])))
          << s.name << ", block " << b << ", value " << i;
      ASSERT_GE(parts[6], -1e-12 * std::abs(beauty[i])) << s.name;
    }
  }
}

TEST(Layers, OfLightAddUpToThePictureWhichTheyLeaveAlone) {
  for (support::EffectScene s : support::named_effect_scenes()) {
    s.settings.width = 12;
    s.settings.height = 10;
    for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
      s.settings.light_model = model;
      expect_beside(s, 5);
    }
  }
  for (std::uint64_t seed = 1; seed <= 40; ++seed) expect_beside(support::random_effect_room(seed), 3);
  support::EffectScene branching = support::effect_room(EffectSet::everything());
  branching.settings.branches = 3;
  branching.settings.max_depth = 4;
  expect_beside(branching, 2);
}

class Room : public testing::Test {
 protected:
  Room() {
    settings_ = room_.settings;
    settings_.width = 18;
    settings_.height = 10;
    settings_.layers = all_layers();
  }
  support::EffectScene room_ = support::effect_room(EffectSet::everything());
  std::shared_ptr<const PreparedScene> scene_ = room_.builder.prepare();
  RenderSettings settings_;
};

TEST_F(Room, HasTheSameLayersHoweverItIsCut) {
  const auto blocks = blocks_for(21);
  const Made whole = made_of(*scene_, settings_, blocks);
  EXPECT_GT(*std::max_element(whole.samples.begin(), whole.samples.end()), 20.0F);
  expect_same(whole, made_of(*scene_, settings_, blocks, 3, 1), "bands of 3 rows, a block a task");
  expect_same(whole, made_of(*scene_, settings_, blocks, 1, 4), "bands of 1 row, 4 blocks a task");
}

TEST_F(Room, ExtendedHasTheLayersOfAllSamplesAtOnce) {
  const auto early = blocks_for(21), all = blocks_for(32);
  Made extended = made_of(*scene_, settings_, early);
  const PixelRect frame{0, 0, settings_.width, settings_.height};
  extended.film.drop_incomplete();
  extended.layers.drop_incomplete();
  const TileResult rest = render_tile(*scene_, settings_, frame, std::span(all).subspan(early.size() - 1), {});
  merge(extended.film, rest);
  merge(extended.layers, rest);
  extended.samples.assign(extended.samples.size(), 32.0F);
  expect_same(made_of(*scene_, settings_, all), extended, "21 and 11 more");
}

TEST_F(Room, AWindowHasThePixelsOfTheWholePicture) {
  const auto blocks = blocks_for(3);
  const Made whole = made_of(*scene_, settings_, blocks);
  RenderSettings window = settings_;
  window.crop = Crop{5, 2, settings_.width, settings_.height};
  window.width = window.height = 4;
  const Made part = made_of(*scene_, window, blocks);
  for (const Layer layer : layers_in(settings_.layers)) {
    const std::size_t channels = spec(layer).channels;
    const auto large = whole[layer], small = part[layer];
    for (std::size_t y = 0; y < 4; ++y) {
      EXPECT_EQ(std::memcmp(&small[4 * channels * y], &large[channels * (18 * (y + 2) + 5)], 4 * channels * sizeof(float)), 0)
          << spec(layer).name;
    }
  }
}

TEST_F(Room, OneLayerAloneIsWhatItIsAmongAll) {
  const auto blocks = blocks_for(3);
  const Made all = made_of(*scene_, settings_, blocks);
  for (const Layer layer : layers_in(settings_.layers)) {
    RenderSettings alone = settings_;
    alone.layers = LayerSet();
    alone.layers.insert(layer);
    EXPECT_TRUE(same_bytes(made_of(*scene_, alone, blocks)[layer], all[layer])) << spec(layer).name;
  }
}

}  // namespace
}  // namespace raykiln::render
