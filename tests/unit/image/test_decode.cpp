#include <gtest/gtest.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <limits>

#include "raykiln/image/decode.hpp"
#include "raykiln/image/encode.hpp"
#include "raykiln/image/layers.hpp"

namespace raykiln::render {
namespace {

Image gradient() {
  Image image{.width = 5, .height = 3, .rgb = {}};
  for (int i = 0; i < 45; ++i) image.rgb.push_back(0.02F * static_cast<float>(i));
  return image;
}

Bytes exr_with(const std::vector<std::string>& channels) {
  Bytes bytes;
  OIIO::Filesystem::IOVecOutput sink(bytes);
  OIIO::ImageSpec spec(2, 1, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = channels;
  spec.attribute("raykiln:seed", "7");
  std::vector<float> values;
  for (std::size_t pixel = 0; pixel < 2; ++pixel) {
    for (std::size_t c = 0; c < channels.size(); ++c) {
      values.push_back(static_cast<float>(10 * pixel) + static_cast<float>(c));
    }
  }
  const auto output = OIIO::ImageOutput::create("a.exr");
  EXPECT_TRUE(output->set_ioproxy(&sink) && output->open("a.exr", spec) &&
              output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
  return bytes;
}

DecodedImage decoded(const Bytes& bytes) {
  auto result = decode_image(bytes);
  const auto* error = std::get_if<DecodeError>(&result);
  EXPECT_EQ(error, nullptr) << error->message;
  return error != nullptr ? DecodedImage{} : std::get<DecodedImage>(std::move(result));
}

TEST(Decode, ReadsWhatWasEncoded) {
  const auto encoded = encode_exr(gradient(), {{"raykiln:samples", "64"}, {"Artist", "somebody"}});
  const DecodedImage image = decoded(std::get<Bytes>(encoded));
  EXPECT_EQ(image.image.rgb, gradient().rgb);
  EXPECT_FALSE(image.display);
  EXPECT_TRUE(image.error.empty());
  EXPECT_EQ(image.attributes, (std::map<std::string, std::string>{{"raykiln:samples", "64"}}));
}

TEST(Decode, APngIsItsDisplayValues) {
  const auto encoded = encode_png(gradient(), 0.5);
  const DecodedImage image = decoded(std::get<Bytes>(encoded));
  EXPECT_TRUE(image.display);
  const Image shown = display_values(gradient(), 0.5);
  ASSERT_EQ(image.image.rgb.size(), shown.rgb.size());
  for (std::size_t i = 0; i < shown.rgb.size(); ++i) EXPECT_NEAR(image.image.rgb[i], shown.rgb[i], 0.51 / 255.0);
}

TEST(Decode, ErrorAndSamplesAreFoundByName) {
  const DecodedImage image =
      decoded(exr_with({"B", "G", "R", "error.B", "error.G", "error.R", "samples"}));
  // The library may reorder R, G, B; what counts is that each value came from the channel of its name.
  EXPECT_EQ(image.image.rgb, (std::vector<float>{2, 1, 0, 12, 11, 10}));
  EXPECT_EQ(image.error, (std::vector<float>{5, 4, 3, 15, 14, 13}));
  EXPECT_EQ(image.samples, (std::vector<float>{6, 16}));
  EXPECT_EQ(image.attributes.at("raykiln:seed"), "7");
}

TEST(Decode, NoiseSurvivesTheFile) {
  const std::vector<float> error = gradient().rgb, samples(15, 64.0F);
  const std::vector<ExtraPlane> planes{{"error", error}, {"samples", samples}};
  const auto encoded = encode_exr(gradient(), {{"raykiln:seed", "3"}}, planes);
  ASSERT_TRUE(std::holds_alternative<Bytes>(encoded));
  const DecodedImage image = decoded(std::get<Bytes>(encoded));
  EXPECT_EQ(image.image.rgb, gradient().rgb);
  EXPECT_EQ(image.error, error);
  EXPECT_EQ(image.samples, samples);
}

TEST(Decode, FurtherLayersKeepTheirNamesAndLeaveThePictureAlone) {
  const std::vector<float> depth(15, std::numeric_limits<float>::infinity()), normal = gradient().rgb;
  std::vector<ExtraPlane> planes{{"depth", depth}, {"normal", normal}};
  planes[0].channels = spec(Layer::kDepth).exr_channels;
  planes[1].channels = spec(Layer::kNormal).exr_channels;
  const auto encoded = encode_exr(gradient(), {}, planes);
  ASSERT_TRUE(std::holds_alternative<Bytes>(encoded));
  const Bytes& bytes = std::get<Bytes>(encoded);
  EXPECT_EQ(decoded(bytes).image.rgb, gradient().rgb);
  const std::string head(bytes.begin(), bytes.begin() + 500);
  for (const char* name : {"R", "Z", "N.X", "N.Y", "N.Z"}) {
    // A channel: its name, and 2 for 32-bit floats.
    EXPECT_NE(head.find(std::string(name) + '\0' + '\2'), std::string::npos) << name;
  }
}

TEST(Decode, LayersAndGrey) {
  EXPECT_EQ(decoded(exr_with({"beauty.R", "beauty.G", "beauty.B", "depth.Z"})).image.rgb,
            (std::vector<float>{0, 1, 2, 10, 11, 12}));
  EXPECT_EQ(decoded(exr_with({"Y"})).image.rgb, (std::vector<float>{0, 0, 0, 10, 10, 10}));
  EXPECT_EQ(decoded(exr_with({"A", "Y"})).image.rgb, (std::vector<float>{1, 1, 1, 11, 11, 11}));
}

TEST(Decode, RefusesWhatIsNoPicture) {
  const auto fails = [](const Bytes& bytes) { return std::holds_alternative<DecodeError>(decode_image(bytes)); };
  EXPECT_TRUE(fails({}));
  EXPECT_TRUE(fails({'h', 'e', 'l', 'l', 'o'}));
  EXPECT_TRUE(fails(exr_with({"depth.Z", "id"})));
  std::vector<std::string> many{"R", "G", "B"};
  for (int i = 0; i < kMostDecodedChannels; ++i) many.push_back(std::to_string(i));
  EXPECT_TRUE(fails(exr_with(many)));
  for (Bytes whole : {std::get<Bytes>(encode_exr(gradient(), {})), std::get<Bytes>(encode_png(gradient(), 0.0))}) {
    for (const std::size_t length : {std::size_t{4}, std::size_t{20}, whole.size() / 2}) {
      EXPECT_TRUE(fails(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)))) << length;
    }
  }
}

}  // namespace
}  // namespace raykiln::render
