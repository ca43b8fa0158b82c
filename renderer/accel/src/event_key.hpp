// One end of a triangle's clipped extent on an axis, as a 64-bit integer whose order is the order
// of the sweep (Wald & Havran 2006, section 4.2): position, then end < planar < start, then id.
#pragma once

#include <bit>
#include <cstdint>

#include "raykiln/math/float_bits.hpp"

namespace raykiln::render {

using EventKey = std::uint64_t;

enum class EventType : std::uint32_t { kEnd = 0, kPlanar = 1, kStart = 2 };

inline constexpr unsigned kEventIdBits = 30;
inline constexpr std::uint32_t kMaxEventId = (1U << kEventIdBits) - 1;

[[nodiscard]] inline EventKey make_event(float position, EventType type, std::uint32_t id) {
  return (EventKey{ordered_key(position)} << 32) |
         (EventKey{static_cast<std::uint32_t>(type)} << kEventIdBits) | id;
}
[[nodiscard]] inline std::uint32_t event_id(EventKey key) {
  return static_cast<std::uint32_t>(key) & kMaxEventId;
}
[[nodiscard]] inline EventType event_type(EventKey key) {
  return static_cast<EventType>((key >> kEventIdBits) & 3U);
}
/// The position as an unsigned integer in the order of floats.
[[nodiscard]] inline std::uint32_t event_rank(EventKey key) {
  return static_cast<std::uint32_t>(key >> 32);
}
/// Inverse of ordered_key (which maps -0 to +0).
[[nodiscard]] inline float rank_to_float(std::uint32_t rank) {
  return std::bit_cast<float>((rank & 0x80000000U) != 0 ? rank ^ 0x80000000U : ~rank);
}
[[nodiscard]] inline EventKey with_event_id(EventKey key, std::uint32_t id) {
  return (key & ~EventKey{kMaxEventId}) | id;
}

}  // namespace raykiln::render
