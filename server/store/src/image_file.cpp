#include "image_file.hpp"

#include <array>
#include <cstring>
#include <fstream>

#include "file_ops.hpp"
#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

/// Written and read on the same machine: byte order is its own.
struct Head {
  char magic[8] = {'R', 'K', 'I', 'M', 'G', '1', '\n', '\0'};  ///< '2': with layers
  std::uint32_t width = 0, height = 0;
  Digest digest{};
};
static_assert(sizeof(Head) == 48);

/// A head that claims more is torn or forged.
constexpr std::uint32_t kMaxSide = 1U << 16U;

constexpr std::size_t kMagicVersion = 5;
constexpr std::uint64_t kPictureFloats = 3, kLayerFloats = 5;  ///< a pixel

std::array<const std::vector<float>*, 4> planes(const StoredImage& image) {
  return {&image.rgb, &image.error, &image.samples, &image.seconds};
}

Digest digest_of(const StoredImage& image) {
  Sha256 hash;
  for (const auto* plane : planes(image)) hash.update(std::as_bytes(std::span(*plane)));
  return hash.finish();
}

bool has_layers(const StoredImage& image) {
  return image.error.size() == image.rgb.size() && 3 * image.samples.size() == image.rgb.size() &&
         image.seconds.size() == image.samples.size();
}

Error torn(const std::string& why) {
  return {ErrorKind::kInternal, "internal", "the stored picture is damaged: " + why, ""};
}

}  // namespace

std::uint64_t image_file_bytes(const StoredImage& image) {
  std::uint64_t floats = image.rgb.size();
  if (has_layers(image)) floats += image.rgb.size() / kPictureFloats * kLayerFloats;
  return sizeof(Head) + floats * sizeof(float);
}

Status write_image_file(const std::filesystem::path& path, const StoredImage& image) {
  if (!has_layers(image) && !(image.error.empty() && image.samples.empty() && image.seconds.empty())) {
    return Error{ErrorKind::kInternal, "internal", "the layers do not fit the picture", ""};
  }
  Head head;
  if (has_layers(image)) head.magic[kMagicVersion] = '2';
  head.width = static_cast<std::uint32_t>(image.width);
  head.height = static_cast<std::uint32_t>(image.height);
  head.digest = digest_of(image);
  auto file = create_file(path);
  if (!file) return file.error();
  if (auto s = write_all(file->get(), std::as_bytes(std::span(&head, 1))); !s) return s;
  for (const auto* plane : planes(image)) {
    if (auto s = write_all(file->get(), std::as_bytes(std::span(*plane))); !s) return s;
  }
  return sync_file(file->get());
}

Result<StoredImage> read_image_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorKind::kNotFound, "image_not_ready", "there is no picture yet", ""};
  Head head;
  Head expected;
  file.read(reinterpret_cast<char*>(&head), sizeof head);
  const bool layers = file && head.magic[kMagicVersion] == '2';
  if (layers) expected.magic[kMagicVersion] = '2';
  if (!file || std::memcmp(head.magic, expected.magic, sizeof head.magic) != 0) return torn("head");
  if (head.width > kMaxSide || head.height > kMaxSide) return torn("size");
  const std::uint64_t pixels = std::uint64_t{head.width} * head.height;
  const std::uint64_t floats = pixels * (kPictureFloats + (layers ? kLayerFloats : 0));
  std::error_code error;
  if (std::filesystem::file_size(path, error) != sizeof head + floats * sizeof(float)) {
    return torn("length");
  }
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
  if (!file) return torn("length");
  if (digest_of(image) != head.digest) return torn("digest");
  return image;
}

}  // namespace raykiln::server
