// A request as part of a record.
#pragma once

#include "raykiln/base/record.hpp"
#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

void write_request(RecordWriter& record, const JobRequest& request);
[[nodiscard]] JobRequest read_request(const RecordReader& record);

}  // namespace raykiln::server
