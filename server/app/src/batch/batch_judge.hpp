// From a rendered EXR to a verdict and the files of the report.
#pragma once

#include <filesystem>
#include <vector>

#include "batch_result.hpp"

namespace raykiln::server {

/// Writes the picture's files below `folder` and compares it with its reference; fills what `result` says of
/// it. The error of a disk is returned, everything else is in the result.
[[nodiscard]] Status judge_render(const BatchPlan& plan, const PlannedPicture& planned,
                                  const std::vector<std::uint8_t>& exr, const std::filesystem::path& folder,
                                  PictureResult& result);

/// "code: text (where)".
[[nodiscard]] std::string failure_text(const Error& error);

}  // namespace raykiln::server
