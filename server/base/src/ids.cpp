#include "raykiln/base/ids.hpp"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

namespace raykiln::server {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

bool is_hex(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

}  // namespace

std::string random_id(std::string_view prefix) {
  std::array<std::uint8_t, 16> bits{};
  if (::getentropy(bits.data(), bits.size()) != 0) throw std::runtime_error("no system randomness");
  static constexpr std::string_view kDigits = "0123456789abcdefghijklmnopqrstuv";
  std::string id(prefix);
  unsigned pool = 0;
  int held = 0;
  for (const std::uint8_t byte : bits) {
    pool = (pool << 8U) | byte;
    held += 8;
    while (held >= 5) {
      held -= 5;
      id += kDigits[(pool >> static_cast<unsigned>(held)) & 31U];
    }
    pool &= (1U << static_cast<unsigned>(held)) - 1U;
  }
  id += kDigits[(pool << static_cast<unsigned>(5 - held)) & 31U];
  return id;
}

bool is_plain_id(std::string_view text, std::size_t max_length) {
  return !text.empty() && text.size() <= max_length && std::all_of(text.begin(), text.end(), is_plain);
}

bool is_sha256_hex(std::string_view text) {
  return text.size() == 64 && std::all_of(text.begin(), text.end(), is_hex);
}

}  // namespace raykiln::server
