#include "accuracy_report.hpp"

#include <algorithm>
#include <limits>

#include "../json_text.hpp"
#include "../text_format.hpp"

namespace raykiln::server {
namespace {

using render::Study;
using render::StudyPoint;

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text + "  ";
}

std::string percent(double fraction) { return short_number(100.0 * fraction) + " %"; }
std::string reached(double value, const std::string& text) { return value < 0.0 ? "not reached" : text; }

std::string point_json(const StudyPoint& point) {
  return "{\"samples\":" + std::to_string(point.samples) + ",\"seconds\":" + json_number(point.seconds) +
         ",\"error\":" + json_number(point.error) + ",\"display_rmse\":" + json_number(point.display_rmse) + "}";
}

std::string number_or_null(double value) { return value < 0.0 ? "null" : json_number(value); }

std::string line_json(const KnobLine& line) {
  const render::VariantCurve& curve = *line.curve;
  const render::Bias& bias = curve.bias;
  std::string points;
  for (const StudyPoint& point : curve.points) points.append(points.empty() ? "" : ",").append(point_json(point));
  return "{\"knob\":" + json_string(curve.variant.name) + ",\"what\":" + json_string(curve.variant.what) +
         ",\"error_at_equal_time\":" + number_or_null(line.error) +
         ",\"seconds_to_equal_error\":" + number_or_null(line.seconds) +
         ",\"build_seconds\":" + json_number(curve.build_seconds) +
         ",\"bias\":{\"value\":" + json_number(bias.value) + ",\"at_most\":" + json_number(bias.at_most) +
         ",\"certain\":" + (bias.certain ? "true" : "false") +
         ",\"brightness\":" + json_number(bias.brightness) +
         ",\"brightness_error\":" + json_number(bias.brightness_error) + "},\"points\":[" + points + "]}";
}

}  // namespace

AccuracyReport accuracy_report(std::string scene, Study study) {
  AccuracyReport report;
  const render::RenderSettings& settings = study.curves.front().variant.settings;
  report.scene = std::move(scene);
  report.width = settings.width;
  report.height = settings.height;
  report.study = std::move(study);
  report.seconds = std::numeric_limits<double>::infinity();
  for (const auto& curve : report.study.curves) report.seconds = std::min(report.seconds, curve.points.back().seconds);
  const auto& plain = report.study.curves.front().points;
  report.error = render::error_at(plain, report.seconds);
  if (report.error < 0.0) report.error = plain.front().error;
  return report;
}

std::vector<KnobLine> knob_lines(const AccuracyReport& report) {
  std::vector<KnobLine> lines;
  for (const auto& curve : report.study.curves) {
    KnobLine line{.curve = &curve,
                  .error = render::error_at(curve.points, report.seconds),
                  .seconds = render::seconds_to(curve.points, report.error)};
    const KnobLine& plain = lines.empty() ? line : lines.front();
    line.error_ratio = line.error / plain.error;
    line.seconds_ratio = line.seconds / plain.seconds;
    lines.push_back(line);
  }
  return lines;
}

std::string bias_text(const render::Bias& bias) {
  const std::string most = " (at most " + percent(bias.at_most) + ")";
  return (bias.certain ? percent(bias.value) : "none found") + most;
}

std::string reference_text(const AccuracyReport& report) {
  const render::StudyReference& r = report.study.reference;
  if (r.smallest_error <= 0.0) return "The picture is black, or no sample of it varies: there is no error to measure.";
  return "Reference: defaults with other seeds, " + std::to_string(r.samples) + " samples, " + short_number(r.seconds) +
         " s; its own error is " + percent(r.error) + ", " + short_number(r.smallest_error / r.error) +
         " times below the smallest one shown" +
         (r.exact_enough() ? "." : ": less than 10 times, so small errors are not to be trusted. Give it more --reference-seconds.");
}

std::string accuracy_text(const AccuracyReport& report) {
  std::size_t width = 4;
  for (const auto& curve : report.study.curves) width = std::max(width, curve.variant.name.size());
  std::string text = padded("knob", width) + padded("error in " + short_number(report.seconds) + " s", 18) +
                     padded("seconds to " + percent(report.error), 20) + "bias\n";
  for (const KnobLine& line : knob_lines(report)) {
    text += padded(line.curve->variant.name, width) +
            padded(reached(line.error, percent(line.error) + " (" + short_number(line.error_ratio) + "x)"), 18) +
            padded(reached(line.seconds, short_number(line.seconds) + " (" + short_number(line.seconds_ratio) + "x)"), 20) +
            bias_text(line.curve->bias) + '\n';
  }
  return text + reference_text(report) + '\n';
}

std::string accuracy_json(const AccuracyReport& report) {
  const render::StudyReference& r = report.study.reference;
  std::string lines;
  for (const KnobLine& line : knob_lines(report)) lines.append(lines.empty() ? "" : ",").append(line_json(line));
  return "{\"scene\":" + json_string(report.scene) + ",\"width\":" + std::to_string(report.width) +
         ",\"height\":" + std::to_string(report.height) + ",\"equal_seconds\":" + json_number(report.seconds) +
         ",\"equal_error\":" + json_number(report.error) + ",\"reference\":{\"samples\":" + std::to_string(r.samples) +
         ",\"seconds\":" + json_number(r.seconds) + ",\"error\":" + json_number(r.error) +
         ",\"smallest_error\":" + json_number(r.smallest_error) +
         ",\"exact_enough\":" + (r.exact_enough() ? "true" : "false") + "},\"knobs\":[" + lines + "]}\n";
}

std::string accuracy_csv(const AccuracyReport& report) {
  std::string text = "knob,samples,seconds,error,display_rmse\n";
  for (const auto& curve : report.study.curves) {
    for (const StudyPoint& p : curve.points) {
      text += curve.variant.name + ',' + std::to_string(p.samples) + ',' + json_number(p.seconds) + ',' +
              json_number(p.error) + ',' + json_number(p.display_rmse) + '\n';
    }
  }
  return text;
}

}  // namespace raykiln::server
