// Four floats at a time, as the compiler's vector extension gives them on every processor.
#pragma once

#include <array>
#include <cstring>

namespace raykiln::render {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

inline constexpr Int4 kThreeLanes{-1, -1, -1, 0};

/// Three floats and a zero from an array that is followed by four more bytes.
[[nodiscard]] inline Float4 load3(const std::array<float, 3>& from) {
  Int4 bits;
  std::memcpy(&bits, from.data(), sizeof bits);
  bits &= kThreeLanes;  // the fourth would be an id: as a number subnormal, and slow
  Float4 value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace raykiln::render
