#include "image_file.hpp"

#include <cstring>
#include <fstream>

#include "file_ops.hpp"
#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

/// Written and read on the same machine: byte order is its own.
struct Head {
  char magic[8] = {'R', 'K', 'I', 'M', 'G', '1', '\n', '\0'};
  std::uint32_t width = 0, height = 0;
  Digest digest{};
};
static_assert(sizeof(Head) == 48);

/// A head that claims more is torn or forged.
constexpr std::uint32_t kMaxSide = 1U << 16U;

Digest digest_of(const std::vector<float>& rgb) {
  Sha256 hash;
  hash.update(std::as_bytes(std::span(rgb)));
  return hash.finish();
}

Error torn(const std::string& why) {
  return {ErrorKind::kInternal, "internal", "the stored picture is damaged: " + why, ""};
}

}  // namespace

std::uint64_t image_file_bytes(const StoredImage& image) {
  return sizeof(Head) + image.rgb.size() * sizeof(float);
}

Status write_image_file(const std::filesystem::path& path, const StoredImage& image) {
  Head head;
  head.width = static_cast<std::uint32_t>(image.width);
  head.height = static_cast<std::uint32_t>(image.height);
  head.digest = digest_of(image.rgb);
  auto file = create_file(path);
  if (!file) return file.error();
  if (auto s = write_all(file->get(), std::as_bytes(std::span(&head, 1))); !s) return s;
  if (auto s = write_all(file->get(), std::as_bytes(std::span(image.rgb))); !s) return s;
  return sync_file(file->get());
}

Result<StoredImage> read_image_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorKind::kNotFound, "image_not_ready", "there is no picture yet", ""};
  Head head;
  const Head expected;
  file.read(reinterpret_cast<char*>(&head), sizeof head);
  if (!file || std::memcmp(head.magic, expected.magic, sizeof head.magic) != 0) return torn("head");
  if (head.width > kMaxSide || head.height > kMaxSide) return torn("size");
  const std::uint64_t floats = std::uint64_t{3} * head.width * head.height;
  std::error_code error;
  if (std::filesystem::file_size(path, error) != sizeof head + floats * sizeof(float)) {
    return torn("length");
  }
  StoredImage image{static_cast<int>(head.width), static_cast<int>(head.height), {}};
  image.rgb.resize(floats);
  file.read(reinterpret_cast<char*>(image.rgb.data()),
            static_cast<std::streamsize>(floats * sizeof(float)));
  if (!file) return torn("length");
  if (digest_of(image.rgb) != head.digest) return torn("digest");
  return image;
}

}  // namespace raykiln::server
