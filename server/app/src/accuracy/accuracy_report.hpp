// The forms in which a study of knobs is told.
#pragma once

#include <string>

#include "raykiln/study/study.hpp"

namespace raykiln::server {

/// A study and what it was of.
struct AccuracyReport {
  std::string scene;  ///< as it was named
  int width = 0, height = 0;
  render::Study study;
  double seconds = 0.0;   ///< at which errors are compared: what all curves reach
  double error = 0.0;     ///< at which times are compared: that of the defaults then
};

/// Chooses the time and the error at which knobs are compared.
[[nodiscard]] AccuracyReport accuracy_report(std::string scene, render::Study study);

/// What a line of the table says; negative numbers where a curve does not reach.
struct KnobLine {
  const render::VariantCurve* curve = nullptr;
  double error = 0.0;        ///< at the common time
  double error_ratio = 0.0;  ///< over that of the defaults
  double seconds = 0.0;      ///< to the common error
  double seconds_ratio = 0.0;
};
[[nodiscard]] std::vector<KnobLine> knob_lines(const AccuracyReport& report);

/// "0.031 (at most 0.034)", "none found (at most 0.002)".
[[nodiscard]] std::string bias_text(const render::Bias& bias);
/// How exact the reference is, and whether that is enough.
[[nodiscard]] std::string reference_text(const AccuracyReport& report);

[[nodiscard]] std::string accuracy_text(const AccuracyReport& report);
[[nodiscard]] std::string accuracy_json(const AccuracyReport& report);
/// One line a point: knob,samples,seconds,error,display_rmse.
[[nodiscard]] std::string accuracy_csv(const AccuracyReport& report);
/// Self-contained: table and plot, no script.
[[nodiscard]] std::string accuracy_html(const AccuracyReport& report);
/// Error against seconds, both logarithmic, a line a knob, the most exact at its time in bold.
[[nodiscard]] std::string accuracy_svg(const AccuracyReport& report);

}  // namespace raykiln::server
