// What the error of a finished picture is, in one line for people.
#pragma once

#include <string>

#include "raykiln/api/job_json.hpp"

namespace raykiln::server {

/// "error 1.9 % (95 %: 1.8 % to 2.0 %) after 121 samples, stopped by error", then what was missed and what to mind, in
/// words with what can be done about it; empty without an error.
[[nodiscard]] std::string accuracy_line(const JobSnapshot& job);
[[nodiscard]] std::string accuracy_line(const JobView& job);

}  // namespace raykiln::server
