// What a job knows about the error of its picture. renderer/accuracy defines the figures.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/jobs/job_request.hpp"

namespace raykiln::server {

/// A value with its 95 % interval.
struct ErrorFigure {
  double value = 0.0, low = 0.0, high = 0.0;
};

struct PictureError {
  std::string grade = "unknown";  ///< "unknown", "rough" or "measured"
  ErrorFigure error, rmse, display_rmse;  ///< meaningless while the grade is "unknown"
  bool heavy_tailed = false;
  std::vector<std::string> notices;  ///< codes of what must be said beside the figures
  std::uint64_t least_samples = 0;   ///< of the poorest pixel
  double mean_samples = 0.0;
  [[nodiscard]] bool known() const { return grade != "unknown"; }
};

/// A notice in words, with what can be done about it; its own code where that is not known here.
[[nodiscard]] std::string remark(std::string_view notice);
/// Whether more samples are what can be done about it.
[[nodiscard]] bool wants_more_samples(std::string_view notice);

/// One point of error against time.
struct CurvePoint {
  double render_seconds = 0.0;  ///< wall time in `rendering`
  double worker_seconds = 0.0;
  double samples = 0.0;         ///< a pixel, mean
  std::uint64_t rays = 0;
  ErrorFigure error;
};

/// Bounded: when full, every second point goes.
inline constexpr std::size_t kMostCurvePoints = 128;
void add_point(std::vector<CurvePoint>& curve, const CurvePoint& point);

/// What ended a job that is completed.
enum class DoneBy { kNone, kSamples, kSeconds, kError };
[[nodiscard]] std::string_view name(DoneBy value);  ///< "", "samples", "seconds", "error"
[[nodiscard]] DoneBy done_by_named(std::string_view name);

/// Samples of every pixel before the error may end a job.
inline constexpr std::uint64_t kErrorFloor = 64;

/// Whether a picture satisfies the target of the rule; false without one. Never below the floor.
[[nodiscard]] bool target_met(const StopRule& rule, const PictureError& error);

/// Samples a pixel at which the error is judged next, after a decision at `samples`: the floor first,
/// then steps of a twentieth, by which the error moves by 2.5 %: so much more than was asked for may be rendered.
[[nodiscard]] std::uint64_t next_decision(std::uint64_t samples);

/// How far an error is on its way to the target, in time: (target / error)^2, at most 0.99.
[[nodiscard]] double target_fraction(const StopRule& rule, const PictureError& error);

}  // namespace raykiln::server
