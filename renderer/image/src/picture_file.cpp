#include "raykiln/image/picture_file.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <type_traits>

#include "colour_channels.hpp"
#include "png_chunks.hpp"
#include "raykiln/math/srgb.hpp"

namespace raykiln::render {
namespace {

constexpr int kMostChannels = 64;
/// No format packs more pixels into a byte: deflate makes 1032 bytes of one, of 8 one-bit pixels each. A
/// header that promises more is a bomb or damaged, and nothing is allocated for it.
constexpr std::uint64_t kMostPixelsOfByte = 1032 * 8;

struct Magic {
  std::string_view bytes;
  PictureFormat format;
};
constexpr std::array<Magic, 5> kMagics{{{"\x89PNG", PictureFormat::kPng},
                                        {"\xFF\xD8\xFF", PictureFormat::kJpeg},
                                        {"\x76\x2F\x31\x01", PictureFormat::kExr},
                                        {"#?RADIANCE", PictureFormat::kHdr},
                                        {"#?RGBE", PictureFormat::kHdr}}};

std::string size_text(const OIIO::ImageSpec& spec) {
  return std::to_string(spec.width) + " x " + std::to_string(spec.height);
}

/// PNG and JPEG of 8 bits stay as they are, everything else becomes floats.
bool stays_bytes(PictureFormat format, const OIIO::ImageSpec& spec) {
  const bool display = format == PictureFormat::kPng || format == PictureFormat::kJpeg;
  return display && spec.format == OIIO::TypeDesc::UINT8;
}

std::optional<PictureFileError> check(PictureFormat format, const OIIO::ImageSpec& spec,
                                      std::size_t file_bytes, const PictureFileLimits& limits) {
  if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels <= 0 || spec.deep) {
    return PictureFileError{.message = "it holds no flat picture"};
  }
  const auto pixels =
      static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);
  if (pixels > limits.max_pixels || spec.nchannels > kMostChannels) {
    return PictureFileError{.message = "it is too large: " + size_text(spec) + ", " +
                            std::to_string(spec.nchannels) + " channels; at most " +
                            std::to_string(limits.max_pixels) + " pixels are read"};
  }
  if (pixels / kMostPixelsOfByte > file_bytes) {
    return PictureFileError{.message = "it is damaged: " + size_text(spec) + " pixels cannot be in " +
                            std::to_string(file_bytes) + " bytes"};
  }
  const std::uint64_t bytes = 3 * pixels * (stays_bytes(format, spec) ? 1 : sizeof(float));
  if (bytes > limits.max_bytes) {
    return PictureFileError{.message = "it is too large: " + size_text(spec), .no_room = true};
  }
  return std::nullopt;
}

/// Channels `from` .. `to` into the front of every pixel of three values.
template <class Value>
bool read_channels(OIIO::ImageInput& input, std::size_t from, std::size_t to, OIIO::TypeDesc type,
                   Value* pixels) {
  return input.read_image(0, 0, static_cast<int>(from), static_cast<int>(to), type, pixels,
                          3 * sizeof(Value));
}

template <class Value>
bool read_pixels(OIIO::ImageInput& input, const std::array<std::size_t, 3>& channels,
                 OIIO::TypeDesc type, std::vector<Value>& values) {
  const OIIO::ImageSpec spec = input.spec();
  values.resize(3 * static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
  const std::size_t r = channels[0];
  if (channels == std::array{r, r + 1, r + 2}) {
    return read_channels(input, r, r + 3, type, values.data());
  }
  if (channels == std::array{r, r, r}) {
    if (!read_channels(input, r, r + 1, type, values.data())) return false;
    for (std::size_t i = 0; i < values.size(); i += 3) values[i + 1] = values[i + 2] = values[i];
    return true;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    if (!read_channels(input, channels[c], channels[c] + 1, type, values.data() + c)) return false;
  }
  return true;
}

template <class Value>
bool read_alpha(OIIO::ImageInput& input, OIIO::TypeDesc type, std::vector<Value>& values) {
  const OIIO::ImageSpec spec = input.spec();
  values.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
  return input.read_image(0, 0, spec.alpha_channel, spec.alpha_channel + 1, type, values.data());
}

template <class Value>
void keep_means(std::vector<Value>& values) {
  const std::size_t pixels = values.size() / 3;
  for (std::size_t i = 0; i < pixels; ++i) {
    const Value* v = &values[3 * i];
    if constexpr (std::is_same_v<Value, float>) {
      values[i] = (v[0] + v[1] + v[2]) / 3.0F;
    } else {
      values[i] = static_cast<Value>((v[0] + v[1] + v[2] + 1) / 3);
    }
  }
  values.resize(pixels);
  values.shrink_to_fit();
}

/// One value a pixel: alpha, or without it the mean of the colours if they are given.
bool read_coverage(OIIO::ImageInput& input, const std::optional<std::array<std::size_t, 3>>& colours,
                   PictureFile& picture) {
  picture.channels = 1;
  const bool bytes = stays_bytes(picture.format, input.spec());
  if (input.spec().alpha_channel >= 0) {
    return bytes ? read_alpha(input, OIIO::TypeDesc::UINT8, picture.srgb8)
                 : read_alpha(input, OIIO::TypeDesc::FLOAT, picture.linear);
  }
  if (!colours) return true;
  const bool read = bytes ? read_pixels(input, *colours, OIIO::TypeDesc::UINT8, picture.srgb8)
                          : read_pixels(input, *colours, OIIO::TypeDesc::FLOAT, picture.linear);
  keep_means(picture.srgb8);
  keep_means(picture.linear);
  return read;
}

bool read_values(OIIO::ImageInput& input, const std::array<std::size_t, 3>& channels,
                 PictureFile& picture) {
  if (stays_bytes(picture.format, input.spec())) {
    return read_pixels(input, channels, OIIO::TypeDesc::UINT8, picture.srgb8);
  }
  if (!read_pixels(input, channels, OIIO::TypeDesc::FLOAT, picture.linear)) return false;
  if (picture.format == PictureFormat::kExr || picture.format == PictureFormat::kHdr) return true;
  for (float& value : picture.linear) {
    value = static_cast<float>(linear_of_srgb(static_cast<double>(value)));
  }
  return true;
}

}  // namespace

std::optional<PictureFormat> picture_format(std::span<const std::uint8_t> bytes) {
  for (const Magic& magic : kMagics) {
    const bool same = bytes.size() >= magic.bytes.size() &&
                      std::equal(magic.bytes.begin(), magic.bytes.end(), bytes.begin(),
                                 [](char c, std::uint8_t byte) {
                                   return static_cast<std::uint8_t>(c) == byte;
                                 });
    if (same) return magic.format;
  }
  return std::nullopt;
}

std::string_view name(PictureFormat format) {
  switch (format) {
    case PictureFormat::kPng: return "png";
    case PictureFormat::kJpeg: return "jpeg";
    case PictureFormat::kExr: return "exr";
    case PictureFormat::kHdr: break;
  }
  return "hdr";
}

namespace {

using PictureOrError = std::variant<PictureFile, PictureFileError>;

PictureOrError decode_file(std::span<const std::uint8_t> bytes, const PictureFileLimits& limits,
                           PictureChannels wanted) {
  const auto format = picture_format(bytes);
  if (!format) return PictureFileError{.message = "it is neither PNG nor JPEG, EXR or HDR"};
  if (*format == PictureFormat::kPng && !png_is_whole(bytes)) {
    return PictureFileError{.message = "the PNG file is cut short or damaged"};
  }
  OIIO::Filesystem::IOMemReader source(bytes.data(), bytes.size());
  OIIO::ImageSpec wish;
  wish["oiio:UnassociatedAlpha"] = 1;  // else colours come multiplied by alpha
  const std::string kind(name(*format));
  const auto input = OIIO::ImageInput::create(kind);
  if (!input || !input->set_ioproxy(&source)) return PictureFileError{.message = "no reader for " + kind};
  OIIO::ImageSpec spec;
  if (!input->open("a." + kind, spec, wish)) {
    return PictureFileError{.message = "it cannot be read: " + input->geterror()};
  }
  if (auto error = check(*format, input->spec(), bytes.size(), limits)) return *error;
  auto channels = colour_channels(input->spec().channelnames);
  if (!channels) return PictureFileError{.message = "it has no channels R, G, B"};
  PictureFile picture{.format = *format,
                      .width = input->spec().width,
                      .height = input->spec().height,
                      .srgb8 = {},
                      .linear = {}};
  if (wanted == PictureChannels::kAlpha) channels.reset();
  if (wanted == PictureChannels::kColour ? !read_values(*input, *channels, picture)
                                         : !read_coverage(*input, channels, picture)) {
    return PictureFileError{.message = "it cannot be read: " + input->geterror()};
  }
  return picture;
}

}  // namespace

PictureOrError read_picture_file(std::span<const std::uint8_t> bytes, const PictureFileLimits& limits,
                                 PictureChannels channels) {
  try {
    return decode_file(bytes, limits, channels);
  } catch (const std::bad_alloc&) {  // the library's buffers for a very wide picture
    return PictureFileError{.message = "memory ran out while it was decoded", .no_room = true};
  }
}

}  // namespace raykiln::render
