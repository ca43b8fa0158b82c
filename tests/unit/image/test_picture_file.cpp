// Pictures of other programs, whole and damaged.
#include <gtest/gtest.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>

#include "raykiln/image/encode.hpp"
#include "raykiln/image/picture_file.hpp"
#include "raykiln/math/srgb.hpp"

namespace raykiln::render {
namespace {

/// 3 x 2 pixels with these channels; value of channel c in pixel i: i * 20 + c + 1, as `type`.
Bytes written(const char* format, const std::vector<std::string>& channels, OIIO::TypeDesc type) {
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput sink(bytes);
  OIIO::ImageSpec spec(3, 2, static_cast<int>(channels.size()), type);
  spec.channelnames = channels;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("Compression", "jpeg:100");
  std::vector<std::uint8_t> small;
  std::vector<float> real;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t c = 0; c < channels.size(); ++c) {
      small.push_back(static_cast<std::uint8_t>(20 * i + c + 1));
      real.push_back(static_cast<float>(small.back()) / 255.0F);
    }
  }
  const std::string name = std::string("a.") + format;
  const auto output = OIIO::ImageOutput::create(name);
  const bool bytewise = type == OIIO::TypeDesc::UINT8;
  const void* values = bytewise ? static_cast<const void*>(small.data()) : real.data();
  EXPECT_TRUE(output->set_ioproxy(&sink) && output->open(name, spec) &&
              output->write_image(bytewise ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT, values) &&
              output->close());
  return bytes;
}

PictureFile read(const Bytes& bytes) {
  auto result = read_picture_file(bytes, {.max_pixels = 100});
  const auto* error = std::get_if<PictureFileError>(&result);
  EXPECT_EQ(error, nullptr) << error->message;
  return error != nullptr ? PictureFile{} : std::get<PictureFile>(std::move(result));
}

TEST(PictureFile, PngKeepsItsBytesAndColoursAreNotMultipliedByAlpha) {
  for (const std::vector<std::string>& channels :
       {std::vector<std::string>{"R", "G", "B"}, std::vector<std::string>{"R", "G", "B", "A"}}) {
    const PictureFile picture = read(written("png", channels, OIIO::TypeDesc::UINT8));
    EXPECT_EQ(picture.format, PictureFormat::kPng);
    EXPECT_EQ(picture.width, 3);
    EXPECT_EQ(picture.height, 2);
    ASSERT_EQ(picture.srgb8.size(), 18U);
    EXPECT_TRUE(picture.linear.empty());
    for (std::size_t i = 0; i < 18; ++i) EXPECT_EQ(picture.srgb8[i], 20 * (i / 3) + i % 3 + 1);
  }
}

TEST(PictureFile, AlphaIsOneValueAndNothingWhereThereIsNone) {
  const auto alone = [](const Bytes& bytes, PictureChannels wanted) {
    auto result = read_picture_file(bytes, {.max_pixels = 100}, wanted);
    EXPECT_TRUE(std::holds_alternative<PictureFile>(result));
    return std::get<PictureFile>(std::move(result));
  };
  const auto with = written("png", {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT8);
  const auto without = written("png", {"R", "G", "B"}, OIIO::TypeDesc::UINT8);
  for (const PictureChannels wanted : {PictureChannels::kAlpha, PictureChannels::kAlphaOrGrey}) {
    const PictureFile picture = alone(with, wanted);
    EXPECT_EQ(picture.channels, 1);
    EXPECT_EQ(picture.srgb8, (std::vector<std::uint8_t>{4, 24, 44, 64, 84, 104}));
  }
  const PictureFile none = alone(without, PictureChannels::kAlpha);
  EXPECT_TRUE(none.srgb8.empty() && none.linear.empty());
  EXPECT_EQ(alone(without, PictureChannels::kAlphaOrGrey).srgb8, (std::vector<std::uint8_t>{2, 22, 42, 62, 82, 102}));
  const PictureFile fine = alone(written("png", {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT16), PictureChannels::kAlpha);
  ASSERT_EQ(fine.linear.size(), 6U);
  EXPECT_NEAR(fine.linear[5], 104.0 / 255.0, 2e-5);  // no curve
}

TEST(PictureFile, GreyIsAllThree) {
  const PictureFile picture = read(written("png", {"Y"}, OIIO::TypeDesc::UINT8));
  ASSERT_EQ(picture.srgb8.size(), 18U);
  for (std::size_t i = 0; i < 18; ++i) EXPECT_EQ(picture.srgb8[i], 20 * (i / 3) + 1);
}

TEST(PictureFile, SixteenBitsBecomeLinear) {
  const PictureFile picture = read(written("png", {"R", "G", "B"}, OIIO::TypeDesc::UINT16));
  ASSERT_EQ(picture.linear.size(), 18U);
  for (std::size_t i = 0; i < 18; ++i) {
    const double display = static_cast<double>(20 * (i / 3) + i % 3 + 1) / 255.0;
    EXPECT_NEAR(picture.linear[i], linear_of_srgb(display), 2e-5);
  }
}

TEST(PictureFile, JpegIsClose) {
  const PictureFile picture = read(written("jpeg", {"R", "G", "B"}, OIIO::TypeDesc::UINT8));
  EXPECT_EQ(picture.format, PictureFormat::kJpeg);
  ASSERT_EQ(picture.srgb8.size(), 18U);
  for (std::size_t i = 0; i < 18; ++i) EXPECT_NEAR(picture.srgb8[i], static_cast<double>(20 * (i / 3) + i % 3 + 1), 12);
}

TEST(PictureFile, LinearFormatsStayAsTheyAre) {
  for (const char* format : {"exr", "hdr"}) {
    const PictureFile picture = read(written(format, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT));
    ASSERT_EQ(picture.linear.size(), 18U) << format;
    EXPECT_TRUE(picture.srgb8.empty());
    for (std::size_t i = 0; i < 18; ++i) {
      const double value = static_cast<double>(20 * (i / 3) + i % 3 + 1) / 255.0;
      EXPECT_NEAR(picture.linear[i], value, format[0] == 'e' ? 1e-7 : 0.008 * value + 1e-3) << format;
    }
  }
}

TEST(PictureFile, ChannelsOfAnExrAreFoundByName) {
  const PictureFile picture =
      read(written("exr", {"depth", "B", "G", "R"}, OIIO::TypeDesc::FLOAT));
  ASSERT_EQ(picture.linear.size(), 18U);
  EXPECT_NEAR(picture.linear[0], 4.0 / 255.0, 1e-7);
  EXPECT_NEAR(picture.linear[1], 3.0 / 255.0, 1e-7);
  EXPECT_NEAR(picture.linear[2], 2.0 / 255.0, 1e-7);
}

TEST(PictureFile, SizeIsCheckedBeforeItIsAllocated) {
  const Bytes bytes = written("png", {"R", "G", "B"}, OIIO::TypeDesc::UINT8);
  EXPECT_TRUE(std::holds_alternative<PictureFile>(read_picture_file(bytes, {.max_pixels = 6})));
  const auto refused = read_picture_file(bytes, {.max_pixels = 5});
  ASSERT_TRUE(std::holds_alternative<PictureFileError>(refused));
  EXPECT_NE(std::get<PictureFileError>(refused).message.find("3 x 2"), std::string::npos);
}

TEST(PictureFile, AHeaderCannotPromiseWhatTheFileIsTooSmallFor) {
  const std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 21474837\n\x80\x80\x80\x80";
  const Bytes bytes(text.begin(), text.end());
  const auto read = read_picture_file(bytes, {.max_pixels = std::uint64_t{1} << 26});
  ASSERT_TRUE(std::holds_alternative<PictureFileError>(read));
  EXPECT_NE(std::get<PictureFileError>(read).message.find("cannot be in"), std::string::npos);
}

TEST(PictureFile, OtherFormatsAreRefused) {
  for (const std::string text : {"", "BM", "GIF89a.....", "II*\0........", "<svg></svg>", "#?", "\x89PN"}) {
    const Bytes bytes(text.begin(), text.end());
    EXPECT_TRUE(std::holds_alternative<PictureFileError>(read_picture_file(bytes, {.max_pixels = 100}))) << text;
  }
}

// Damage of any kind ends in a picture or in an error, never in a crash or a wrong size.
TEST(PictureFile, SurvivesDamage) {
  std::uint64_t state = 1;
  const auto next = [&state] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return state >> 33;
  };
  int refused = 0, accepted = 0;
  for (const char* format : {"png", "jpeg", "exr", "hdr"}) {
    const bool small = format[0] == 'p' || format[0] == 'j';
    const Bytes whole = written(format, {"R", "G", "B"},
                                small ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
    for (int i = 0; i < 300; ++i) {
      Bytes bytes = whole;
      for (std::uint64_t k = next() % 4 + 1; k > 0; --k) {
        bytes[next() % bytes.size()] = static_cast<std::uint8_t>(next());
      }
      if (next() % 4 == 0) bytes.resize(next() % bytes.size());
      const auto result = read_picture_file(bytes, {.max_pixels = 10000});
      if (const auto* picture = std::get_if<PictureFile>(&result)) {
        ++accepted;
        const auto pixels = static_cast<std::size_t>(picture->width * picture->height);
        EXPECT_LE(pixels, 10000U);
        EXPECT_EQ(picture->srgb8.size() + picture->linear.size(), 3 * pixels);
      } else {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(accepted, 100);
}

TEST(SrgbCurve, KnownValues) {
  EXPECT_EQ(linear_of_srgb(0.0), 0.0);
  EXPECT_EQ(linear_of_srgb(1.0), 1.0);
  EXPECT_NEAR(linear_of_srgb(0.5), 0.21404114, 1e-8);
  EXPECT_NEAR(linear_of_srgb(0.04045), 0.0031308, 1e-7);
  EXPECT_EQ(srgb_of_linear(0.0), 0.0);
  EXPECT_NEAR(srgb_of_linear(1.0), 1.0, 1e-15);
  EXPECT_NEAR(srgb_of_linear(0.21404114), 0.5, 1e-8);
  EXPECT_NEAR(srgb_of_linear(0.0031308), 0.04045, 1e-6);
}

/// A texture that is decoded and encoded again is the same file.
TEST(SrgbCurve, EveryByteComesBack) {
  for (int byte = 0; byte < 256; ++byte) {
    EXPECT_EQ(std::lround(255.0 * srgb_of_linear(linear_of_srgb(byte / 255.0))), byte);
    EXPECT_EQ(srgb_of_linear(linear_of_srgb(byte / 255.0)) <= 1.0, true) << byte;
  }
}

}  // namespace
}  // namespace raykiln::render
