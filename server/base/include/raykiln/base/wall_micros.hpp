// Wall time as records and tables keep it.
#pragma once

#include <cstdint>

#include "raykiln/base/clock.hpp"

namespace raykiln::server {

/// Microseconds since the epoch of system_clock.
[[nodiscard]] inline std::int64_t to_micros(WallTime time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}
[[nodiscard]] inline WallTime from_micros(std::int64_t micros) {
  return WallTime(std::chrono::duration_cast<WallTime::duration>(std::chrono::microseconds(micros)));
}

}  // namespace raykiln::server
