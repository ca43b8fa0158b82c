#include "png_chunks.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace raykiln::render {
namespace {

constexpr std::size_t kSignature = 8;
constexpr std::size_t kAround = 12;  ///< length, type and check sum of a chunk
constexpr std::array<std::uint8_t, 4> kEnd{'I', 'E', 'N', 'D'};

std::size_t big_endian(std::span<const std::uint8_t> bytes) {
  std::size_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

}  // namespace

bool png_is_whole(std::span<const std::uint8_t> bytes) {
  for (std::size_t at = kSignature; at + kAround <= bytes.size();) {
    const std::size_t length = big_endian(bytes.subspan(at, 4));
    if (length > bytes.size() - at - kAround) return false;
    if (std::equal(kEnd.begin(), kEnd.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at + 4))) return true;
    at += kAround + length;
  }
  return false;
}

}  // namespace raykiln::render
