// Whether one more job may wait.
#pragma once

#include <cstddef>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// Success, or ErrorKind::kTooMany with code "queue_full" and retry_after_s: the time in which one
/// place is likely to be free, `seconds_per_job` being the mean of late (0: unknown), 1 .. 600 s.
[[nodiscard]] Status admit(std::size_t queued, std::size_t max_queued, double seconds_per_job,
                           std::size_t active);

}  // namespace raykiln::server
