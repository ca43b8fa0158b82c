// What a tile's rendering counted, in the words of a job's statistics.
#pragma once

#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::server {

inline constexpr std::size_t kMaxLocatedSamples = 16;

/// Adds the counts of one result, and where its samples were not finite, up to kMaxLocatedSamples.
void add_counts(JobStatistics& sum, const render::TileResult& result);

}  // namespace raykiln::server
