// F01-F05: the range of files, display colours, odd shapes of pictures, where a pixel lies.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hard/support/members.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/image/encode.hpp"
#include "raykiln/selftest/coverage.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using namespace render::selftest;

template <typename T>
std::vector<T> read_back(const Bytes& bytes, const char* name) {
  OIIO::Filesystem::IOMemReader reader(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  const auto input = OIIO::ImageInput::open(name, nullptr, &reader);
  if (!input) return {};
  const auto& spec = input->spec();
  std::vector<T> pixels(3 * static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDescFromC<T>::value(), pixels.data())) return {};
  return pixels;
}

Image row_of(const std::vector<float>& values) {
  Image image{.width = static_cast<int>(values.size()), .height = 1, .rgb = {}};
  for (const float value : values) image.rgb.insert(image.rgb.end(), {value, value, value});
  return image;
}

TEST(F01, HalfFloatRange) {
  Row row("F01", "65503, 65504, 65519.99, 65520, 1e6, 1e38, 6e-8, 2.9e-8, negative ones and infinity as EXR half and float",
          "float exact; half clamped to 65504 and counted, no Inf");
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values{65503.0F, 65504.0F, 65519.99F, 65520.0F, 1e6F, 1e38F,
                                  6e-8F, 2.9e-8F, -1.5F, -1e6F, inf, 0.0F};
  const Image image = row_of(values);
  const auto whole = encode_exr(image, {});
  ASSERT_TRUE(std::holds_alternative<Bytes>(whole));
  EXPECT_EQ(read_back<float>(std::get<Bytes>(whole), "a.exr"), image.rgb);
  const auto encoded = encode_half_exr(image, {});
  ASSERT_TRUE(std::holds_alternative<HalfExr>(encoded));
  const HalfExr& half = std::get<HalfExr>(encoded);
  const auto pixels = read_back<float>(half.bytes, "a.exr");
  ASSERT_EQ(pixels.size(), image.rgb.size());
  const std::vector<float> expected{65504.0F, 65504.0F, 65504.0F, 65504.0F, 65504.0F, 65504.0F,
                                    0x1p-24F, 0.0F, -1.5F, -65504.0F, 65504.0F, 0.0F};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(pixels[3 * i], expected[i]) << values[i];
  EXPECT_EQ(half.clamped, 3U * 6U);
  EXPECT_EQ(half.vanished, 3U);
  row.measured("clamped", half.clamped);
  row.measured("vanished", half.vanished);
}

TEST(F01, RandomRadiances) {
  Members members(5001);
  Row row("F01", "1e5 random floats of all magnitudes" + members.note(), "float exact; half within 2^-11 or 2^-25; counts exact");
  std::vector<float> values;
  std::uint64_t beyond = 0, wrong = 0;
  for (int i = 0; i < 99999; ++i) {
    values.push_back(static_cast<float>(members.scale(1e-12, 1e12)) * (i % 7 == 0 ? -1.0F : 1.0F));
    beyond += std::abs(values.back()) > 65504.0F ? 1 : 0;
  }
  const Image image{.width = 33333, .height = 1, .rgb = values};
  EXPECT_EQ(read_back<float>(std::get<Bytes>(encode_exr(image, {})), "a.exr"), image.rgb);
  const auto half = std::get<HalfExr>(encode_half_exr(image, {}));
  const auto pixels = read_back<float>(half.bytes, "a.exr");
  ASSERT_EQ(pixels.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float clamped = std::clamp(values[i], -65504.0F, 65504.0F);
    wrong += std::abs(pixels[i] - clamped) > std::max(0x1p-11F * std::abs(clamped), 0x1p-25F) ? 1 : 0;
  }
  row.never("wrong", wrong, values.size());
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(half.clamped, beyond);
}

TEST(F02, DisplayConversion) {
  Row row("F02", "0, 0.0031308, 0.18, 0.2140411, 0.5, 1, 1.5, -0.1, NaN to 8-bit sRGB", "0, 10, 118, 127, 188, 255, 255, 0; NaN black and counted");
  const Image image = row_of({0.0F, 0.0031308F, 0.18F, 0.2140411F, 0.5F, 1.0F, 1.5F, -0.1F,
                              std::numeric_limits<float>::quiet_NaN()});
  const auto pixels = read_back<std::uint8_t>(std::get<Bytes>(encode_png(image, 0.0)), "a.png");
  const std::vector<int> expected{0, 10, 118, 127, 188, 255, 255, 0, 0};
  ASSERT_EQ(pixels.size(), 3 * expected.size());
  std::string shown_values;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(pixels[3 * i], expected[i]);
    shown_values += (i == 0 ? "" : ", ") + std::to_string(pixels[3 * i]);
  }
  EXPECT_EQ(nan_values(image), 3U);
  row.measured("", shown_values);
}

Scene furnace(float albedo) {
  SmallScene s;
  s.box(Vec3f(-1), Vec3f(1), s.material(matte(albedo, 1.0F - albedo)), true);
  s.look({0.1, 0.2, 0.3}, {1, 0.3, 0.1}, {0, 0, 1}, 1.0);
  return s.scene();
}

TEST(F03, OddImageShapes) {
  Row row("F03", "furnace of 1x1, 1x4096, 4096x1, 3x3, 7x5 pixels, whole and by windows that touch the border",
          "every pixel exactly spp samples; mean E/(1 - rho), 4 sigma and the cut of depth 64", "physical");
  const Scene scene = furnace(0.5F);
  const auto shared = std::make_shared<const Scene>(scene);
  SerialTaskRunner runner;
  const auto ready = prepare(shared, build_scene_tree(*shared, {}, runner));
  std::uint64_t wrong = 0, pixels = 0;
  double worst = 0.0;
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 4096}, {4096, 1}, {3, 3}, {7, 5}}) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.max_depth = 64;
    const std::uint64_t samples = width * height == 1 ? 256 : 5;
    const Measured m = measure(scene, settings, samples);
    worst = std::max(worst, std::abs(m.mean - 1.0));
    EXPECT_TRUE(render::selftest::within_four_sigma(m, 1.0, 1e-6)) << against(m, 1.0);
    Film film(width, height);
    const auto blocks = blocks_for(samples);
    for (int y = 0; y < height; y += 2) {
      for (int x = 0; x < width; x += 3) {
        const PixelRect window{x, y, std::min(x + 3, width), std::min(y + 2, height)};
        merge(film, render_tile(*ready, settings, window, blocks, {}));
      }
    }
    for (const double n : film.plane("samples")) {
      ++pixels;
      wrong += n != static_cast<double>(samples) ? 1 : 0;
    }
    EXPECT_EQ(selftest::bit_hash(film), selftest::bit_hash(render_film(scene, settings, samples)));
  }
  row.never("wrong counts", wrong, pixels);
  row.measured("largest |mean - 1|", worst);
  EXPECT_EQ(wrong, 0U);
}

// The field of view is the vertical one, whatever the shape: an edge at a known height stays there.
TEST(F03, FieldOfViewIsVertical) {
  Row row("F03", "half plane below row 2 of 4, pictures 1, 4 and 64 pixels wide", "rows 0, 1 black; rows 2, 3 white");
  std::uint64_t wrong = 0, pixels = 0;
  for (const int width : {1, 4, 64}) {
    const Scene scene = half_plane_scene({0.0, -1.0, -2.0}, width, 4);
    RenderSettings settings;
    settings.width = width;
    settings.height = 4;
    settings.max_depth = 0;
    const auto values = measure(scene, settings, 4).pixels;
    for (std::size_t i = 0; i < values.size(); ++i, ++pixels) {
      const double expected = i / static_cast<std::size_t>(width) < 2 ? 0.0 : 1.0;
      wrong += std::abs(values[i] - expected) > 1e-12 ? 1 : 0;
    }
  }
  row.never("wrong pixels", wrong, pixels);
  EXPECT_EQ(wrong, 0U);
}

TEST(F04, PixelGeometryConvention) {
  Members members(5004);
  Row row("F04", "step edge at x = k + f and y = k + f of 8 x 6 pixels, random and centre mode" + members.note(),
          "random: coverage f of that pixel, 4 sigma; centre: the pixel whose centre is covered");
  const std::uint64_t samples = 4096;
  double worst = 0.0;
  for (int i = 0; i < 24; ++i) {
    const bool vertical = i % 2 == 0;
    const int along = static_cast<int>(members.bits() % (vertical ? 8 : 6));
    const double f = i < 2 ? 0.25 : members.between(0.1, 0.9), c = along + f;
    const Scene scene = half_plane_scene({vertical ? 1.0 : 0.0, vertical ? 0.0 : 1.0, c}, 8, 6);
    RenderSettings settings;
    settings.width = 8;
    settings.height = 6;
    settings.max_depth = 0;
    const auto random = measure(scene, settings, samples).pixels;
    settings.pixel_mode = PixelMode::kCentre;
    const auto centre = measure(scene, settings, 1).pixels;
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        const auto at = static_cast<std::size_t>(8 * y + x);
        const int k = vertical ? x : y;
        const double area = std::clamp(c - k, 0.0, 1.0);
        const double z = std::abs(random[at] - area) / std::max(std::sqrt(area * (1 - area) / samples), 1e-9);
        worst = std::max(worst, z);
        if (std::abs(k + 0.5 - c) > 1e-3) {
          EXPECT_NEAR(centre[at], k + 0.5 < c ? 1.0 : 0.0, 1e-12);
        }
      }
    }
  }
  row.measured("largest |z| of 1152 pixels", worst);
  EXPECT_LE(worst, sidak_z(1152.0, 6.3e-5));
}

TEST(F04, RowsFromTheTop) {
  Row row("F04", "a picture white in its upper left pixel alone", "pixel 0 of film, EXR and PNG");
  SmallScene s;
  s.quad({Vec3f(0, -1, 0), {1, -1, 0}, {1, 0, 0}, {0, 0, 0}}, s.material(matte(0, 1)));
  s.look({1.5, -1, 4}, {1.5, -1, 0}, {0, 1, 0}, 2.0 * std::atan(0.25));
  RenderSettings settings;
  settings.width = 3;
  settings.height = 2;
  settings.max_depth = 0;
  const Image image = render_film(s.scene(), settings, 4).resolve();
  std::vector<float> expected(18, 0.0F);
  expected[0] = expected[1] = expected[2] = 1.0F;
  EXPECT_EQ(image.rgb, expected);
  EXPECT_EQ(read_back<float>(std::get<Bytes>(encode_exr(image, {})), "a.exr"), expected);
  EXPECT_EQ(read_back<std::uint8_t>(std::get<Bytes>(encode_png(image, 0)), "a.png")[0], 255);
  EXPECT_EQ(read_back<std::uint8_t>(std::get<Bytes>(encode_png(image, 0)), "a.png")[9], 0);
  row.measured("", "first row first");
}

TEST(F05, DepthOfTheFileAgainstTheEstimate) {
  Members members(5005);
  Row row("F05", "film of random radiances, written as float EXR" + members.note(),
          "mean in the file = accumulator to 1 ulp; averages in linear light");
  double worst = 0.0;
  std::uint64_t pixels = 0;
  for (int i = 0; i < 20; ++i) {
    Film film(16, 4);
    std::vector<long double> exact(16 * 4 * 3, 0.0L);
    const auto blocks = blocks_for(48);
    for (const SampleBlock& block : blocks) {
      BlockResult result{block, make_block_planes(64)};
      for (std::uint64_t k = 0; k < block.count; ++k) {
        for (std::size_t p = 0; p < 64; ++p) {
          const Rgbd value(members.scale(1e-9, 1e9), members.scale(1e-9, 1e9), members.scale(1e-9, 1e9));
          add_sample(result.planes, p, value, false);
          for (int c = 0; c < 3; ++c) exact[3 * p + static_cast<std::size_t>(c)] += value[c];
        }
      }
      film.fold({0, 0, 16, 4}, result);
    }
    const auto file = read_back<float>(std::get<Bytes>(encode_exr(film.resolve(), {})), "a.exr");
    ASSERT_EQ(file.size(), exact.size());
    for (std::size_t p = 0; p < exact.size(); ++p, ++pixels) {
      worst = std::max(worst, relative_error(static_cast<double>(file[p]), static_cast<double>(exact[p] / 48.0L)));
    }
  }
  row.measured("largest relative error, in u", worst / kUnit);
  row.measured("values", pixels);
  EXPECT_LE(worst, 2.0 * kUnit);
}

}  // namespace
}  // namespace raykiln::hard
