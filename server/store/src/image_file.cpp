#include "image_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "file_ops.hpp"
#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

/// Written and read on the same machine: byte order is its own.
struct Head {
  char magic[8] = {'R', 'K', 'I', 'M', 'G', '1', '\n', '\0'};  ///< '2': with error, samples and seconds; '3': with further layers, too
  std::uint32_t width = 0, height = 0;
  Digest digest{};
};
static_assert(sizeof(Head) == 48);

/// A head that claims more is torn or forged.
constexpr std::uint32_t kMaxSide = 1U << 16U;

constexpr std::size_t kMagicVersion = 5;
constexpr std::uint32_t kMostLayers = 64, kMostChannels = 4, kMostNameBytes = 64;

/// Before the values of each further layer, and once more with 0 channels behind the last one.
struct LayerHead {
  char name[kMostNameBytes] = {};  ///< filled up with zeros
  std::uint32_t channels = 0;
};
constexpr std::uint64_t kPictureFloats = 3, kLayerFloats = 5;  ///< a pixel

std::array<const std::vector<float>*, 4> planes(const StoredImage& image) {
  return {&image.rgb, &image.error, &image.samples, &image.seconds};
}

LayerHead head_of(const StoredLayer& layer, std::uint64_t pixels) {
  LayerHead head;
  std::copy_n(layer.name.begin(), std::min<std::size_t>(layer.name.size(), kMostNameBytes), head.name);
  head.channels = pixels == 0 ? 0 : static_cast<std::uint32_t>(layer.values.size() / pixels);
  return head;
}

bool layers_fit(const StoredImage& image) {
  const std::uint64_t pixels = image.rgb.size() / kPictureFloats;
  return image.layers.size() <= kMostLayers &&
         std::all_of(image.layers.begin(), image.layers.end(), [&](const StoredLayer& layer) {
           const std::uint64_t channels = pixels == 0 ? 0 : layer.values.size() / pixels;
           return channels >= 1 && channels <= kMostChannels && layer.values.size() == channels * pixels &&
                  !layer.name.empty() && layer.name.size() <= kMostNameBytes;
         });
}

Digest digest_of(const StoredImage& image) {
  Sha256 hash;
  for (const auto* plane : planes(image)) hash.update(std::as_bytes(std::span(*plane)));
  for (const StoredLayer& layer : image.layers) {
    const LayerHead head = head_of(layer, image.rgb.size() / kPictureFloats);
    hash.update(std::as_bytes(std::span(&head, 1)));
    hash.update(std::as_bytes(std::span(layer.values)));
  }
  return hash.finish();
}

bool has_layers(const StoredImage& image) {
  return image.error.size() == image.rgb.size() && 3 * image.samples.size() == image.rgb.size() &&
         image.seconds.size() == image.samples.size();
}

Error torn(const std::string& why) {
  return {ErrorKind::kInternal, "internal", "the stored picture is damaged: " + why, ""};
}

/// What follows the planes: `bytes` in all. False when it is not that.
bool read_layers(std::ifstream& file, std::uint64_t bytes, std::uint64_t pixels, StoredImage& image) {
  while (image.layers.size() <= kMostLayers) {
    LayerHead head;
    if (bytes < sizeof head) return false;
    file.read(reinterpret_cast<char*>(&head), sizeof head);
    bytes -= sizeof head;
    if (!file || head.channels == 0) return file && bytes == 0;
    const std::uint64_t of_layer = head.channels * pixels * sizeof(float);
    if (head.channels > kMostChannels || bytes < of_layer) return false;
    StoredLayer layer{std::string(head.name, ::strnlen(head.name, kMostNameBytes)),
                      std::vector<float>(head.channels * pixels)};
    file.read(reinterpret_cast<char*>(layer.values.data()), static_cast<std::streamsize>(of_layer));
    bytes -= of_layer;
    image.layers.push_back(std::move(layer));
  }
  return false;
}

}  // namespace

std::uint64_t image_file_bytes(const StoredImage& image) {
  std::uint64_t floats = image.rgb.size();
  if (has_layers(image)) floats += image.rgb.size() / kPictureFloats * kLayerFloats;
  for (const StoredLayer& layer : image.layers) floats += layer.values.size();
  const std::uint64_t heads = image.layers.empty() ? 0 : image.layers.size() + 1;
  return sizeof(Head) + heads * sizeof(LayerHead) + floats * sizeof(float);
}

Status write_image_file(const std::filesystem::path& path, const StoredImage& image) {
  const bool bare = image.error.empty() && image.samples.empty() && image.seconds.empty() && image.layers.empty();
  if ((!has_layers(image) && !bare) || !layers_fit(image)) {
    return Error{ErrorKind::kInternal, "internal", "the layers do not fit the picture", ""};
  }
  Head head;
  if (has_layers(image)) head.magic[kMagicVersion] = image.layers.empty() ? '2' : '3';
  head.width = static_cast<std::uint32_t>(image.width);
  head.height = static_cast<std::uint32_t>(image.height);
  head.digest = digest_of(image);
  auto file = create_file(path);
  if (!file) return file.error();
  if (auto s = write_all(file->get(), std::as_bytes(std::span(&head, 1))); !s) return s;
  for (const auto* plane : planes(image)) {
    if (auto s = write_all(file->get(), std::as_bytes(std::span(*plane))); !s) return s;
  }
  for (const StoredLayer& layer : image.layers) {
    const LayerHead of_layer = head_of(layer, image.rgb.size() / kPictureFloats);
    if (auto s = write_all(file->get(), std::as_bytes(std::span(&of_layer, 1))); !s) return s;
    if (auto s = write_all(file->get(), std::as_bytes(std::span(layer.values))); !s) return s;
  }
  if (!image.layers.empty()) {
    const LayerHead end;
    if (auto s = write_all(file->get(), std::as_bytes(std::span(&end, 1))); !s) return s;
  }
  return sync_file(file->get());
}

Result<StoredImage> read_image_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorKind::kNotFound, "image_not_ready", "there is no picture", ""};
  Head head;
  Head expected;
  file.read(reinterpret_cast<char*>(&head), sizeof head);
  const char version = file ? head.magic[kMagicVersion] : '1';
  const bool further = version == '3', layers = version == '2' || further;
  if (layers) expected.magic[kMagicVersion] = version;
  if (!file || std::memcmp(head.magic, expected.magic, sizeof head.magic) != 0) return torn("head");
  if (head.width > kMaxSide || head.height > kMaxSide) return torn("size");
  const std::uint64_t pixels = std::uint64_t{head.width} * head.height;
  const std::uint64_t floats = pixels * (kPictureFloats + (layers ? kLayerFloats : 0));
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(path, error), least = sizeof head + floats * sizeof(float);
  if (error || (further ? bytes < least : bytes != least)) return torn("length");
  StoredImage image{static_cast<int>(head.width), static_cast<int>(head.height), {}};
  const auto read = [&](std::vector<float>& plane, std::uint64_t values) {
    plane.resize(values);
    file.read(reinterpret_cast<char*>(plane.data()), static_cast<std::streamsize>(values * sizeof(float)));
  };
  read(image.rgb, kPictureFloats * pixels);
  if (layers) {
    read(image.error, kPictureFloats * pixels);
    read(image.samples, pixels);
    read(image.seconds, pixels);
  }
  if (!file || (further && !read_layers(file, bytes - least, pixels, image))) return torn("length");
  if (digest_of(image) != head.digest) return torn("digest");
  return image;
}

}  // namespace raykiln::server
