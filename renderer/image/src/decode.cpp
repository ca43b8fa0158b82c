#include "raykiln/image/decode.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "colour_channels.hpp"
#include "png_chunks.hpp"
#include "raykiln/image/display.hpp"

namespace raykiln::render {
namespace {

constexpr std::array<std::uint8_t, 4> kExr{0x76, 0x2F, 0x31, 0x01};
constexpr std::array<std::uint8_t, 4> kPng{0x89, 'P', 'N', 'G'};

using Names = ChannelNames;

std::vector<float> gather(const std::vector<float>& values, std::size_t channels,
                          std::span<const std::size_t> wanted) {
  std::vector<float> result;
  result.reserve(values.size() / channels * wanted.size());
  for (std::size_t i = 0; i < values.size(); i += channels) {
    for (const std::size_t channel : wanted) result.push_back(values[i + channel]);
  }
  return result;
}

std::optional<DecodeError> check(const OIIO::ImageSpec& spec) {
  if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels <= 0 || spec.deep) {
    return DecodeError{"the file holds no flat picture"};
  }
  const auto pixels = static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);
  if (pixels > kMostDecodedPixels || spec.nchannels > kMostDecodedChannels ||
      pixels * static_cast<std::uint64_t>(spec.nchannels) > kMostDecodedValues) {
    return DecodeError{"the picture is too large: " + std::to_string(spec.width) + " x " +
                       std::to_string(spec.height) + ", " + std::to_string(spec.nchannels) + " channels"};
  }
  return std::nullopt;
}

std::map<std::string, std::string> own_attributes(const OIIO::ImageSpec& spec) {
  std::map<std::string, std::string> result;
  for (const auto& attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    if (name.starts_with("raykiln:")) result[name] = attribute.get_string();
  }
  return result;
}

DecodedImage arrange(const OIIO::ImageSpec& spec, const std::vector<float>& values,
                     const std::array<std::size_t, 3>& colour) {
  const Names& names = spec.channelnames;
  const auto channels = static_cast<std::size_t>(spec.nchannels);
  DecodedImage decoded;
  decoded.image = {.width = spec.width, .height = spec.height, .rgb = gather(values, channels, colour)};
  decoded.attributes = own_attributes(spec);
  if (const auto error = channel_triple(names, "error.")) decoded.error = gather(values, channels, *error);
  for (const char* name : {"samples", "samples.Y"}) {
    const auto samples = channel_position(names, name);
    if (samples && decoded.samples.empty()) decoded.samples = gather(values, channels, {{*samples}});
  }
  return decoded;
}

std::variant<DecodedImage, DecodeError> read(const char* format, std::span<const std::uint8_t> bytes) {
  OIIO::Filesystem::IOMemReader source(bytes.data(), bytes.size());
  const auto input = OIIO::ImageInput::open(std::string("a.") + format, nullptr, &source);
  if (!input) return DecodeError{OIIO::geterror()};
  const OIIO::ImageSpec& spec = input->spec();
  if (auto error = check(spec)) return *error;
  const auto colour = colour_channels(spec.channelnames);
  if (!colour) return DecodeError{"the file has no channels R, G, B"};
  std::vector<float> values(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                            static_cast<std::size_t>(spec.nchannels));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data())) {
    return DecodeError{input->geterror()};
  }
  return arrange(spec, values, *colour);
}

bool begins_with(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, 4>& magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

}  // namespace

std::variant<DecodedImage, DecodeError> decode_image(std::span<const std::uint8_t> bytes) {
  const bool exr = begins_with(bytes, kExr), png = begins_with(bytes, kPng);
  if (!exr && !png) return DecodeError{"neither an EXR nor a PNG file"};
  // The library leaks when it meets the end of a PNG before its time.
  if (png && !png_is_whole(bytes)) return DecodeError{"the PNG file is cut off or damaged"};
  auto decoded = read(exr ? "exr" : "png", bytes);
  if (auto* image = std::get_if<DecodedImage>(&decoded)) image->display = png;
  return decoded;
}

Image display_values(const Image& linear, double exposure_stops) {
  const double gain = std::exp2(exposure_stops);
  Image shown = linear;
  for (float& value : shown.rgb) value = static_cast<float>(display_value(gain * static_cast<double>(value)));
  return shown;
}

}  // namespace raykiln::render
