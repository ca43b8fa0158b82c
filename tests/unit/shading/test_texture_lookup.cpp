#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "raykiln/math/srgb.hpp"
#include "raykiln/shading/texture_lookup.hpp"
#include "raykiln/shading/texture_pyramid.hpp"

namespace raykiln::render {
namespace {

/// Width by height texels; texel i is i in all channels.
TextureImage numbered(int width, int height) {
  TextureImage image{.name = "", .width = width, .height = height, .srgb8 = {}, .linear = {}};
  for (int i = 0; i < width * height; ++i) {
    image.linear.insert(image.linear.end(), 3, static_cast<float>(i));
  }
  return image;
}

double at(const TextureImage& image, const TextureUse& use, double u, double v) {
  return texture_value(image, use, u, v).x;
}

TextureUse with_wrap(TextureWrap wrap, TextureFilter filter = TextureFilter::kBilinear) {
  TextureUse use;
  use.wrap_u = use.wrap_v = wrap;
  use.filter = filter;
  return use;
}

TEST(Texture, MiddlesOfTexelsAreTheTexelsAndBetweenIsLinear) {
  const TextureImage image = numbered(4, 2);
  const TextureUse use = with_wrap(TextureWrap::kClamp);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(at(image, use, (i % 4 + 0.5) / 4, (i / 4 + 0.5) / 2), i);
  }
  EXPECT_DOUBLE_EQ(at(image, use, 1.75 / 4, 0.25), 1.25);
  EXPECT_DOUBLE_EQ(at(image, use, 0.5, 0.5), 0.25 * (1 + 2 + 5 + 6));
}

TEST(Texture, WrapModesAtTheEdges) {
  const TextureImage image = numbered(4, 1);
  const double edge = 0.125;  // half a texel
  EXPECT_EQ(at(image, with_wrap(TextureWrap::kClamp), -5.0, 0.5), 0.0);
  EXPECT_EQ(at(image, with_wrap(TextureWrap::kClamp), 7.0, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kRepeat), 0.0, 0.5), 1.5);  // 3 and 0
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kMirror), 0.0, 0.5), 0.0);  // 0 and 0
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kMirror), 1.0, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kRepeat), -3.0 + edge, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kMirror), 1.0 + edge, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kMirror), -edge, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(at(image, with_wrap(TextureWrap::kMirror), 4.0 + 3 * edge, 0.5), 1.0);
}

TEST(Texture, NearestTakesTheTexelItself) {
  const TextureImage image = numbered(4, 1);
  for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
    const TextureUse use = with_wrap(wrap, TextureFilter::kNearest);
    EXPECT_EQ(at(image, use, 0.26, 0.5), 1.0);
    EXPECT_EQ(at(image, use, 0.99, 0.5), 3.0);
    EXPECT_EQ(at(image, use, 0.0, 0.0), 0.0);
  }
  EXPECT_EQ(at(image, with_wrap(TextureWrap::kRepeat, TextureFilter::kNearest), -0.01, 0.5), 3.0);
  EXPECT_EQ(at(image, with_wrap(TextureWrap::kMirror, TextureFilter::kNearest), -0.01, 0.5), 0.0);
}

TEST(Texture, AnyCoordinateIsSafe) {
  const TextureImage image = numbered(3, 5);
  const double inf = std::numeric_limits<double>::infinity();
  for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp}) {
    for (const TextureFilter filter : {TextureFilter::kBilinear, TextureFilter::kNearest}) {
      for (const double u : {-1e-300, -1e-17, 1.0, 2.0, 1e18, -1e300, inf, -inf, std::nan("")}) {
        const double value = at(image, with_wrap(wrap, filter), u, -u);
        EXPECT_TRUE(value >= 0.0 && value <= 14.0) << u;
      }
    }
  }
}

TEST(Texture, BytesAreSrgbAndFilteredInLinearLight) {
  TextureImage image{.name = "", .width = 2, .height = 1, .srgb8 = {0, 128, 255, 255, 128, 0}, .linear = {}};
  const TextureUse use = with_wrap(TextureWrap::kClamp);
  const Rgbd left = texture_value(image, use, 0.25, 0.5);
  EXPECT_EQ(left.x, 0.0);
  EXPECT_NEAR(left.y, linear_of_srgb(128.0 / 255.0), 1e-7);
  EXPECT_EQ(left.z, 1.0);
  EXPECT_DOUBLE_EQ(texture_value(image, use, 0.5, 0.5).x, 0.5);
  EXPECT_DOUBLE_EQ(mean_largest_channel(image), 1.0);
}

/// One triangle whose corners have the coordinates (0, 0), (1, 0), (0, 1).
SurfaceTextures one_triangle(TextureImage image) {
  SurfaceTextures textures;
  textures.images.push_back(std::move(image));
  textures.uv_sets[0].coordinates = {{0, 0}, {1, 0}, {0, 1}};
  textures.uv_sets[0].corners = {{0, 1, 2}, {0, 1, kNoUv}};
  return textures;
}

TEST(Texture, CoordinatesAreInterpolatedAndTransformed) {
  const SurfaceTextures textures = one_triangle(numbered(8, 8));
  TextureUse use = with_wrap(TextureWrap::kClamp, TextureFilter::kNearest);
  use.image = 0;
  const auto value = [&](double u, double v) { return texture_value(textures, use, {0, u, v}).x; };
  EXPECT_EQ(value(0.8, 0.1), 6.0);        // column 6, row 0
  EXPECT_EQ(value(0.1, 0.8), 6.0 * 8.0);  // row 6
  use.u_row = {0.5, 0.0, 0.5};
  use.v_row = {0.0, -1.0, 1.0};
  EXPECT_EQ(value(0.8, 0.1), 7.0 * 8.0 + 7.0);  // u 0.9, v 0.9
}

TEST(Texture, TrianglesWithoutCoordinatesAreWhite) {
  const SurfaceTextures textures = one_triangle(numbered(2, 2));
  TextureUse use;
  use.image = 0;
  EXPECT_EQ(texture_value(textures, use, {1, 0.2, 0.2}), Rgbd(1.0));  // a corner without
  EXPECT_EQ(texture_value(textures, use, {7, 0.2, 0.2}), Rgbd(1.0));  // beyond the set
  use.uv_set = 1;
  EXPECT_EQ(texture_value(textures, use, {0, 0.2, 0.2}), Rgbd(1.0));
}

TextureImage one_texel(const Rgb& value) {
  return {.name = "", .width = 1, .height = 1, .srgb8 = {}, .linear = {value.x, value.y, value.z}};
}

TEST(Texture, DataBytesAreNoColours) {
  TextureImage image{.name = "", .width = 1, .height = 1, .srgb8 = {51, 102, 255}, .linear = {}};
  TextureUse use;
  use.data = true;
  EXPECT_EQ(texture_value(image, use, 0.5, 0.5), Rgbd(51.0, 102.0, 255.0) / 255.0);
}

TEST(Texture, RoughnessIsGreenAndMetallicBlue) {
  SurfaceTextures textures = one_triangle(one_texel({0.1F, 0.5F, 0.25F}));
  textures.materials.resize(1);
  MaterialTextures& used = textures.materials[0];
  used.roughness.image = used.base.image = 0;
  used.metal = {.base = Rgb(1.0F), .metallic = 1.0F, .roughness = 0.5, .f0 = Rgb(0.04F), .edge = 1.0F, .transmission = 0.0F};
  Material material, painted;
  material.model = SurfaceModel::kMicrofacet;
  paint(textures, material, 0, {0, 0.1, 0.1}, painted);
  EXPECT_EQ(painted.facets.roughness, 0.25);
  EXPECT_FLOAT_EQ(painted.diffuse.y, 0.75F * 0.5F);
  EXPECT_FLOAT_EQ(painted.specular.y, 0.25F * 0.5F + 0.75F * 0.04F);
  EXPECT_EQ(painted.facets.edge, 1.0F);
}

// The triangle lies in z = 0 with u along +x and v, which points down in the picture, along +y.
TEST(Texture, NormalsAreBentInTheFrameOfThePicture) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}};
  mesh.triangles = {{0, 1, 2}};
  const Vec3f up(0, 0, 1);
  const auto bent = [&](const Rgb& value, double scale, const Vec3d& u_row) {
    SurfaceTextures textures = one_triangle(one_texel(value));
    textures.materials.resize(1);
    textures.materials[0].normal.image = 0;
    textures.materials[0].normal.u_row = u_row;
    textures.materials[0].normal_scale = scale;
    return mapped_normal(textures, mesh, 0, {0, 0.2, 0.3}, up).value_or(Vec3f(0.0F));
  };
  const Vec3d plain(1, 0, 0), mirrored(-1, 0, 1);
  const auto near = [](const Vec3f& a, const Vec3d& b) { return length(Vec3d(a) - normalize(b)) < 1e-6; };
  EXPECT_TRUE(near(bent({0.5F, 0.5F, 1}, 1.0, plain), {0, 0, 1}));
  EXPECT_TRUE(near(bent({0.75F, 0.5F, 1}, 1.0, plain), {0.5, 0, 1}));
  EXPECT_TRUE(near(bent({0.75F, 0.5F, 1}, 2.0, plain), {1, 0, 1}));
  EXPECT_TRUE(near(bent({0.5F, 0.75F, 1}, 1.0, plain), {0, -0.5, 1}));
  EXPECT_TRUE(near(bent({0.75F, 0.5F, 1}, 1.0, mirrored), {-0.5, 0, 1}));
  EXPECT_TRUE(near(bent({0.5F, 0.75F, 1}, 1.0, mirrored), {0, -0.5, 1}));
  // Coordinates without an extent have no frame.
  EXPECT_EQ(bent({0.75F, 0.5F, 1}, 1.0, {0, 0, 0}), Vec3f(0.0F));
}

TEST(Texture, PaintMultipliesColourAndEmission) {
  TextureImage image{.name = "", .width = 1, .height = 1, .srgb8 = {}, .linear = {0.5F, 0.25F, 1.0F}};
  SurfaceTextures textures = one_triangle(image);
  textures.materials.resize(1);
  textures.materials[0].base.image = 0;
  textures.materials[0].specular_tint = {1.0F, 0.5F, 0.0F};
  textures.materials[0].emission.image = 0;
  Material material, painted;
  material.diffuse = Rgb(0.8F);
  material.specular = Rgb(0.2F);
  material.emission = Rgb(4.0F);
  material.transparent = 0.25F;
  paint(textures, material, 0, {0, 0.1, 0.1}, painted);
  EXPECT_EQ(painted.diffuse, Rgb(0.4F, 0.2F, 0.8F));
  EXPECT_FLOAT_EQ(painted.specular.x, 0.1F);
  EXPECT_FLOAT_EQ(painted.specular.y, 0.2F * 0.625F);
  EXPECT_FLOAT_EQ(painted.specular.z, 0.2F);
  EXPECT_EQ(painted.emission, Rgb(2.0F, 1.0F, 4.0F));
  EXPECT_EQ(painted.transparent, 0.25F);
  EXPECT_EQ(emission_factor(textures, 0, {0, 0.1, 0.1}), Rgbd(0.5, 0.25, 1.0));
  EXPECT_EQ(emission_factor(textures, 3, {0, 0.1, 0.1}), Rgbd(1.0));
}

double mean_of(const TextureImage& image) {
  double sum = 0.0;
  for (const float value : image.linear) sum += static_cast<double>(value);
  return sum / static_cast<double>(image.linear.size());
}

// By area, whatever the sides: an odd row has texels that two of the smaller copy share.
TEST(TexturePyramid, CopiesKeepTheMean) {
  for (const auto& [width, height] : {std::pair{8, 8}, {5, 3}, {1, 7}, {13, 2}, {3, 1}}) {
    TextureImage image = numbered(width, height);
    const double mean = mean_of(image);
    while (image.width > 1 || image.height > 1) {
      image = halved(image, false);
      EXPECT_NEAR(mean_of(image), mean, 1e-5 * mean) << width << ' ' << height << ' ' << image.width;
    }
    EXPECT_EQ(image.linear.size(), 3U);
  }
}

// Half black, half white is half the light as a colour, half the number as a number.
TEST(TexturePyramid, ColoursAreMeansOfLight) {
  const TextureImage image{.name = "", .width = 2, .height = 1, .srgb8 = {0, 0, 0, 255, 255, 255}, .linear = {}};
  EXPECT_EQ(halved(image, false).srgb8, (std::vector<std::uint8_t>{188, 188, 188}));
  EXPECT_EQ(halved(image, true).srgb8, (std::vector<std::uint8_t>{128, 128, 128}));
}

/// 64 x 64 texels, black and white by turns, over a triangle of legs 1 that has half of the picture.
SurfaceTextures checked() {
  SurfaceTextures textures;
  TextureImage image{.name = "", .width = 64, .height = 64, .srgb8 = {}, .linear = {}};
  for (int i = 0; i < 64 * 64; ++i) image.linear.insert(image.linear.end(), 3, (i / 64 + i % 64) % 2 == 0 ? 0.0F : 1.0F);
  textures.images.push_back(std::move(image));
  textures.uv_sets[0].coordinates = {{0, 0}, {1, 0}, {0, 1}};
  textures.uv_sets[0].corners = {{0, 1, 2}};
  textures.materials.resize(1);
  textures.materials[0].base.image = 0;
  return textures;
}

// What was stopped is gone on with by the next who asks, and is the same.
TEST(TexturePyramid, CopiesThatWereStoppedAreMadeLater) {
  const SurfaceTextures textures = checked();
  std::stop_source source;
  source.request_stop();
  EXPECT_FALSE(halved(textures.images[0], false, source.get_token()));
  const TexturePyramids stopped(&textures), straight(&textures);
  EXPECT_FALSE(stopped.make(source.get_token()));
  EXPECT_TRUE(stopped.make());
  EXPECT_TRUE(stopped.make(source.get_token())) << "they are there";
  EXPECT_TRUE(straight.make());
  for (const double level : {0.5, 1.0, 2.3, 6.0}) {
    EXPECT_EQ(stopped.value(textures.materials[0].base, 0.3, 0.4, level), straight.value(textures.materials[0].base, 0.3, 0.4, level));
  }
}

TEST(TexturePyramid, AFootprintReadsWhatItCovers) {
  const SurfaceTextures textures = checked();
  const TexturePyramids pyramids(&textures);
  pyramids.make();
  const auto read = [&](double width_in_texels) {
    const double width = width_in_texels / 64.0;  // of legs, which are 1; twice the area is 1
    const TrianglePlace at{0, 0.5 / 64, 0.5 / 64, &pyramids, width * width};
    return texture_value(textures, textures.materials[0].base, at).x;
  };
  const double exact = texture_value(textures, textures.materials[0].base, {0, 0.5 / 64, 0.5 / 64}).x;
  EXPECT_EQ(exact, 0.0);
  for (const double width : {0.0, 0.5, 1.0, 2.0}) EXPECT_EQ(read(width), exact) << width;
  EXPECT_NEAR(read(2.0 * std::sqrt(2.0)), 0.25, 1e-6);  // half way to the first copy, which is grey
  for (const double width : {4.0, 5.0, 64.0, 1e9, std::numeric_limits<double>::infinity()}) {
    EXPECT_NEAR(read(width), 0.5, 1e-6) << width;
  }
  EXPECT_EQ(read(std::numeric_limits<double>::quiet_NaN()), exact);
  EXPECT_GE(pyramids.bytes(), 1365U * 3 * sizeof(float));
  EXPECT_TRUE(pyramids.make()) << "made already";
  EXPECT_EQ(TexturePyramids(nullptr).bytes(), 0U);
}

}  // namespace
}  // namespace raykiln::render
