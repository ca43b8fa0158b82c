// Jobs as JSON and back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "raykiln/api/problem.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/jobs/job_request.hpp"
#include "raykiln/jobs/job_snapshot.hpp"

namespace raykiln::server {

/// Body of POST /v1/jobs. The problem lists every wrong field.
[[nodiscard]] std::variant<JobRequest, Problem> parse_job_request(std::string_view body,
                                                                  const JobLimits& limits);

/// Body of POST /v1/jobs/{job}/extend.
struct Extension {
  StopRule stop;
  std::optional<int> priority{};
};
[[nodiscard]] std::string extension_json(const Extension& extension);
[[nodiscard]] std::variant<Extension, Problem> parse_extension(std::string_view body, const JobLimits& limits);

/// Body of POST /v1/quotes: a job without a stop, whose pilot takes `pilot_seconds`.
inline constexpr double kPilotSeconds = 2.0, kMostPilotSeconds = 60.0;
[[nodiscard]] std::string quote_request_json(const JobRequest& request, double pilot_seconds);
[[nodiscard]] std::variant<JobRequest, Problem> parse_quote_request(std::string_view body,
                                                                    const JobLimits& limits);

/// With all defaults written out; parse_job_request gives the same request back.
[[nodiscard]] std::string job_request_json(const JobRequest& request);

/// Schema Job, on one line.
[[nodiscard]] std::string job_json(const JobSnapshot& job);
/// Schema JobAccuracy, on one line.
[[nodiscard]] std::string accuracy_json(const JobSnapshot& job);
/// Schema Quote: what less error of this picture costs, from what is known of it by now.
[[nodiscard]] std::string quote_json(const JobSnapshot& job);
[[nodiscard]] std::string job_page_json(const std::vector<JobSnapshot>& jobs,
                                        const std::string& next_cursor);

/// What a client wants to know of a job.
struct JobView {
  std::string id, scene, name, state;
  std::uint64_t revision = 0;
  std::string stage;  ///< while preparing
  double fraction = 0.0, samples_done = 0.0, samples_target = 0.0;
  double elapsed_seconds = 0.0;
  std::optional<double> remaining_seconds;
  double rays_per_second = 0.0;
  std::string approximation;  ///< empty, or the label of effects that lack what the scene calls for
  double render_seconds = 0.0;
  std::optional<PictureError> accuracy;  ///< as last judged; its grade, error, notices and samples
  DoneBy done_by = DoneBy::kNone;
  std::optional<double> target;  ///< of error
  bool target_reached = false;   ///< an error target that was met
  std::vector<std::string> warnings;  ///< "message (where)"
  bool has_image = false;
  std::string error;  ///< empty, or "code: detail (where)"
};

/// What a client wants to know of a quote.
struct QuoteView {
  std::string id;
  double samples = 0.0;  ///< of the pilot, a pixel
  bool heavy_tailed = false;
  struct Price {
    double error = 0.0;
    bool reached = false;
    std::optional<std::pair<double, double>> left{};  ///< seconds more: a 90 % range
  };
  std::vector<Price> prices;
};
[[nodiscard]] std::optional<QuoteView> parse_quote_view(std::string_view text);

/// Nothing when the text is no job.
[[nodiscard]] std::optional<JobView> parse_job_view(std::string_view text);

/// The jobs of a page, and its next cursor; nothing when the text is no page.
struct JobPageView {
  std::vector<JobView> jobs;
  std::string next_cursor;
};
[[nodiscard]] std::optional<JobPageView> parse_job_page(std::string_view text);

/// RFC 3339 in UTC with milliseconds.
[[nodiscard]] std::string rfc3339(WallTime time);

}  // namespace raykiln::server
