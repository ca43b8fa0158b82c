// What each knob costs: error against processor seconds, measured on one scene against a long render.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "raykiln/accel/task_runner.hpp"
#include "raykiln/study/variants.hpp"

namespace raykiln::render {

inline constexpr std::uint64_t kMostStudyPixels = 65536;

struct StudyBudget {
  double seconds = 1.0;              ///< of one processor, for each variant
  double reference_seconds = 300.0;  ///< of one processor, at most
};

/// A variant after so many samples.
struct StudyPoint {
  std::uint64_t samples = 0;  ///< a pixel
  double seconds = 0.0;       ///< of one processor, rendering alone
  double error = 0.0;         ///< root of relMSE against the reference
  double display_rmse = 0.0;
};

/// What samples do not cure: root of relMSE between the limits of variant and reference, from products
/// of independent halves, whose noise does not add up. The square is an estimate that may fall below 0.
struct Bias {
  double value = 0.0;    ///< 0 where the square is below 0
  double at_most = 0.0;  ///< upper end of its one-sided 95 % interval, or of one about 0 if that is higher
  bool certain = false;  ///< the square is above 0 by more than 3 standard errors
  double brightness = 0.0;  ///< relative difference of the mean of all channels
  double brightness_error = 0.0;  ///< its standard error, the reference's included
};

struct VariantCurve {
  Variant variant;
  double build_seconds = 0.0;  ///< of its tree; wall time
  std::vector<StudyPoint> points;
  Bias bias;
};

struct StudyReference {
  std::uint64_t samples = 0;
  double seconds = 0.0;
  double error = 0.0;  ///< its own, from the difference of its halves
  double smallest_error = 0.0;  ///< of all points
  bool black = true;            ///< it has found no light: nothing can be judged
  /// Its error is at most a tenth of the smallest one that is shown.
  [[nodiscard]] bool exact_enough() const { return !black && 10.0 * error <= smallest_error; }
};

struct Study {
  std::vector<VariantCurve> curves;  ///< the defaults first
  StudyReference reference;
};

/// Where a study stands: "measuring" and the variant's name, or "reference".
using StudyProgress = std::function<void(const std::string& stage, double fraction)>;

/// Renders every variant for its time, then the reference (the first variant with other seeds) until it
/// is ten times as exact as the most exact point, or its time is over. Seconds are of the threads'
/// processor clocks, so they wander less than wall time on a busy machine. A black reference leaves all
/// errors 0. Precondition: at most kMostStudyPixels pixels; settings_error() is nothing for each.
[[nodiscard]] Study measure_knobs(std::shared_ptr<const Scene> scene, const std::vector<Variant>& variants,
                                  const StudyBudget& budget, TaskRunner& runner,
                                  const StudyProgress& progress);

/// Error at so many seconds, on the line through the nearest points in the log-log plot; negative when
/// the curve does not reach so far.
[[nodiscard]] double error_at(const std::vector<StudyPoint>& points, double seconds);

/// Seconds to this error, likewise; negative when no point is as exact.
[[nodiscard]] double seconds_to(const std::vector<StudyPoint>& points, double error);

}  // namespace raykiln::render
