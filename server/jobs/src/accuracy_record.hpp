// What is known of a picture's error, as part of a record.
#pragma once

#include "raykiln/base/record.hpp"
#include "raykiln/jobs/job_snapshot.hpp"

namespace raykiln::server {

/// Accuracy, done_by, curve and tile_samples of the job.
void write_accuracy(RecordWriter& record, const JobSnapshot& job);
void read_accuracy(const RecordReader& record, JobSnapshot& job);

/// Every value of a list; 0 for text that is no number.
[[nodiscard]] std::vector<std::uint64_t> naturals(const std::vector<std::string>& list);

}  // namespace raykiln::server
