// Values of options that are more than a number.
#pragma once

#include <optional>
#include <string>

#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

/// "640x480" into width and height; what is wrong with it, or nothing.
[[nodiscard]] std::string read_size(const std::string& text, JobRequest& request);
/// "0.05,2": radius and focus distance.
[[nodiscard]] std::optional<Lens> read_lens(const std::string& text);
/// "0.02" or "2%".
[[nodiscard]] std::optional<double> read_error(std::string text);

}  // namespace raykiln::server
