#include <gtest/gtest.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raykiln/image/encode.hpp"

namespace raykiln::render {
namespace {

template <typename T>
std::vector<T> read_back(const Bytes& bytes, const char* name, OIIO::ImageSpec& spec) {
  OIIO::Filesystem::IOMemReader reader(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  const auto input = OIIO::ImageInput::open(name, nullptr, &reader);
  if (!input) return {};
  spec = input->spec();
  std::vector<T> pixels(3 * static_cast<std::size_t>(spec.width * spec.height));
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDescFromC<T>::value(), pixels.data())) return {};
  return pixels;
}

Image grey_row(const std::vector<float>& values) {
  Image image{.width = static_cast<int>(values.size()), .height = 1, .rgb = {}};
  for (const float value : values) image.rgb.insert(image.rgb.end(), {value, value, value});
  return image;
}

void expect_png(const Image& image, double stops, const std::vector<int>& expected) {
  const auto encoded = encode_png(image, stops);
  ASSERT_TRUE(std::holds_alternative<Bytes>(encoded));
  OIIO::ImageSpec spec;
  const auto pixels = read_back<std::uint8_t>(std::get<Bytes>(encoded), "a.png", spec);
  ASSERT_EQ(pixels.size(), 3 * expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(pixels[3 * i + 1], expected[i]) << i;
}

TEST(EncodePng, KnownColoursRoundExactly) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  expect_png(grey_row({0.0F, 0.0031308F, 0.18F, 0.2140411F, 0.5F, 1.0F, 1.5F, -0.1F, nan, inf}), 0.0,
             {0, 10, 118, 127, 188, 255, 255, 0, 0, 255});
}

TEST(EncodePng, EffortChangesTheBytesButNoPixel) {
  std::vector<float> values;
  for (int i = 0; i < 20'000; ++i) values.push_back(static_cast<float>((i * 7919) % 1000) / 1000.0F);
  const Image image = grey_row(values);
  const auto small = std::get<Bytes>(encode_png(image, 0.0));
  const auto quick = std::get<Bytes>(encode_png(image, 0.0, {}, PngEffort::kQuick));
  EXPECT_NE(small, quick);
  OIIO::ImageSpec spec;
  EXPECT_EQ(read_back<std::uint8_t>(small, "a.png", spec), read_back<std::uint8_t>(quick, "a.png", spec));
}

// Around every value at which the byte changes, and over the whole range, as the formula says.
TEST(EncodePng, EveryByteIsThatOfTheFormula) {
  const auto formula = [](double x) {
    x = std::clamp(x, 0.0, 1.0);
    const double curve = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
    return static_cast<int>(std::lround(255.0 * curve));
  };
  std::vector<float> values;
  std::vector<int> expected;
  for (int i = 0; i < 20'000; ++i) values.push_back(static_cast<float>(i) / 19'000.0F);
  for (int byte = 0; byte < 255; ++byte) {
    const double encoded = (byte + 0.5) / 255.0;
    const double step = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    float near = static_cast<float>(step);
    for (int i = 0; i < 3; ++i) near = std::nextafter(near, 0.0F);
    for (int i = 0; i < 7; ++i, near = std::nextafter(near, 2.0F)) values.push_back(near);
  }
  for (const float value : values) expected.push_back(formula(static_cast<double>(value)));
  expect_png(grey_row(values), 0.0, expected);
}

TEST(EncodePng, ExposureIsInStops) {
  expect_png(grey_row({0.25F, 0.5F, 1.0F}), 1.0, {188, 255, 255});
  expect_png(grey_row({0.25F, 1.0F}), -1.0, {99, 188});
}

TEST(EncodeExr, RoundTripIsExactAndKeepsAttributes) {
  const Image image{.width = 2, .height = 2,
                    .rgb = {0, 1e-30F, 65504, 65520, 1e6F, 1e38F, -1, 3, 4, 5, 6, 0.1F}};
  const auto encoded = encode_exr(image, {{"raykiln:seed", "18446744073709551615"},
                                          {"raykiln:light_model", "seed"}});
  ASSERT_TRUE(std::holds_alternative<Bytes>(encoded));
  OIIO::ImageSpec spec;
  const auto pixels = read_back<float>(std::get<Bytes>(encoded), "a.exr", spec);
  EXPECT_EQ(pixels, image.rgb);
  EXPECT_EQ(spec.format, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(spec.get_string_attribute("raykiln:seed"), "18446744073709551615");
  EXPECT_EQ(spec.get_string_attribute("raykiln:light_model"), "seed");
  EXPECT_EQ(spec.get_string_attribute("DateTime"), "1970:01:01 00:00:00");  // not the present time
}

TEST(Encode, RowZeroIsAtTheTop) {
  const Image image{.width = 1, .height = 2, .rgb = {1, 1, 1, 0, 0, 0}};
  expect_png(image, 0.0, {255, 0});
}

TEST(Encode, AnEmptyOrTornPictureIsAnError) {
  EXPECT_TRUE(std::holds_alternative<EncodeError>(encode_png({}, 0.0)));
  EXPECT_TRUE(std::holds_alternative<EncodeError>(
      encode_exr(Image{.width = 2, .height = 2, .rgb = {1.0F}}, {})));
}

}  // namespace
}  // namespace raykiln::render
