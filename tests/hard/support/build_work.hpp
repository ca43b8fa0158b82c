// The work of a build by counts, which no other program disturbs.
#pragma once

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::hard {

/// What a build did: events looked at and moved, passes over keys, clips.
inline double work_of(const render::BuildStats& stats) {
  return static_cast<double>(stats.events_swept + stats.events_moved + stats.keys_sorted_passes + stats.clips);
}

}  // namespace raykiln::hard
