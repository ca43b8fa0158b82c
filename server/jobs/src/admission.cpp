#include "raykiln/jobs/admission.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace raykiln::server {

Status admit(std::size_t queued, std::size_t max_queued, double seconds_per_job,
             std::size_t active) {
  if (queued < max_queued) return success();
  // A place in the queue is free when the next active job ends: jobs that run side by side share
  // the workers, so that one of n ends about every seconds_per_job / n.
  const double wait = seconds_per_job / static_cast<double>(std::max<std::size_t>(active, 1));
  const double bounded = std::clamp(std::ceil(wait), 1.0, 600.0);
  return Error{ErrorKind::kTooMany, "queue_full",
               std::to_string(queued) + " jobs are waiting already", "",
               std::isfinite(bounded) ? static_cast<int>(bounded) : 600};
}

}  // namespace raykiln::server
