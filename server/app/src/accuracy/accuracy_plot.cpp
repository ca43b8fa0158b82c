#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../text_format.hpp"
#include "accuracy_report.hpp"

namespace raykiln::server {
namespace {

using render::StudyPoint;

constexpr double kWidth = 860.0, kHeight = 460.0;
constexpr double kLeft = 70.0, kRight = 230.0, kTop = 20.0, kBottom = 50.0;
/// Colours that stay apart for colour-blind eyes (Okabe & Ito 2008); dashes tell their repetitions.
constexpr std::array<const char*, 7> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#7f7f7f"};
constexpr std::array<const char*, 3> kDashes{"", "6 3", "2 3"};

/// A logarithmic axis.
struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  double from = 0.0, to = 1.0;  ///< in the drawing

  void take(double value) {
    if (!(value > 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double at(double value) const {
    const double span = std::log(high / low);
    return span > 0.0 ? from + (to - from) * std::log(value / low) / span : from;
  }
};

std::string number(double value) { return short_number(std::round(10.0 * value) / 10.0); }

std::string coordinate(const Axis& x, const Axis& y, const StudyPoint& p) {
  return number(x.at(p.seconds)).append(",").append(number(y.at(p.error))).append(" ");
}

std::string text(double x, double y, const std::string& anchor, const std::string& what) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\">" + what + "</text>";
}

/// Lines at powers of ten and their halves of a decade (1, 3).
std::string grid(const Axis& x, const Axis& y) {
  std::string svg = "<g class=\"grid\">";
  for (int decade = -12; decade <= 12; ++decade) {
    for (const double lead : {1.0, 3.0}) {
      const double value = lead * std::pow(10.0, decade);
      if (value >= x.low && value <= x.high) {
        svg += "<path d=\"M" + number(x.at(value)) + ' ' + number(kTop) + "V" + number(kHeight - kBottom) + "\"/>" +
               text(x.at(value), kHeight - kBottom + 18, "middle", short_number(value));
      }
      if (value >= y.low && value <= y.high) {
        svg += "<path d=\"M" + number(kLeft) + ' ' + number(y.at(value)) + "H" + number(kWidth - kRight) + "\"/>" +
               text(kLeft - 6, y.at(value) + 4, "end", short_number(100.0 * value) + " %");
      }
    }
  }
  return svg + text(0.5 * (kLeft + kWidth - kRight), kHeight - 8, "middle", "seconds of one processor") +
         text(kLeft, kTop - 6, "start", "error") + "</g>";
}

/// A knob that is worse than this many times the worst of the defaults would press all others together.
constexpr double kMostAbove = 3.0;

double highest_shown(const AccuracyReport& report) {
  double worst = 0.0;
  for (const StudyPoint& p : report.study.curves.front().points) worst = std::max(worst, p.error);
  return kMostAbove * worst;
}

std::string curve(const render::VariantCurve& c, std::size_t index, const Axis& x, const Axis& y) {
  std::string line;
  for (const StudyPoint& p : c.points) {
    if (p.error > 0.0 && p.error <= y.high) line += coordinate(x, y, p);
  }
  const std::string colour = kColours[index % kColours.size()];
  const std::string style = "stroke=\"" + colour + "\" stroke-dasharray=\"" + kDashes[index / kColours.size() % kDashes.size()] +
                            "\" stroke-width=\"" + (index == 0 ? "3" : "1.5") + "\"";
  const double row = kTop + 12 + 19.0 * static_cast<double>(index);
  return "<g><title>" + c.variant.what + "</title><polyline fill=\"none\" " + style + " points=\"" + line + "\"/><path " + style +
         " d=\"M" + number(kWidth - kRight + 14) + ' ' + number(row - 4) + "h24\"/>" +
         text(kWidth - kRight + 44, row, "start", c.variant.name) + "</g>";
}

/// The points that no other is better than in both time and error, joined.
std::string front(const AccuracyReport& report, const Axis& x, const Axis& y) {
  std::vector<StudyPoint> all;
  for (const auto& c : report.study.curves) {
    for (const StudyPoint& p : c.points) {
      if (p.error > 0.0) all.push_back(p);
    }
  }
  std::sort(all.begin(), all.end(), [](const StudyPoint& a, const StudyPoint& b) { return a.seconds < b.seconds; });
  std::string line;
  double best = std::numeric_limits<double>::infinity();
  for (const StudyPoint& p : all) {
    if (p.error >= best || p.error > y.high) continue;
    best = p.error;
    line += coordinate(x, y, p);
  }
  return "<polyline class=\"front\" points=\"" + line + "\"><title>Pareto front: nothing else is both faster and more "
         "exact</title></polyline>";
}

}  // namespace

std::string accuracy_svg(const AccuracyReport& report) {
  Axis x, y;
  const double highest = highest_shown(report);
  for (const auto& c : report.study.curves) {
    for (const StudyPoint& p : c.points) {
      if (!(p.error > 0.0)) continue;
      x.take(p.seconds);
      y.take(std::min(p.error, highest));
    }
  }
  if (!(x.high > 0.0)) return {};
  x.from = kLeft, x.to = kWidth - kRight;
  y.from = kHeight - kBottom, y.to = kTop;
  std::string svg = "<svg viewBox=\"0 0 " + number(kWidth) + ' ' + number(kHeight) +
                    "\" role=\"img\" aria-label=\"error against seconds for each knob; the numbers are in the table\">" +
                    grid(x, y) + front(report, x, y);
  for (std::size_t i = 0; i < report.study.curves.size(); ++i) svg += curve(report.study.curves[i], i, x, y);
  return svg + "</svg>";
}

}  // namespace raykiln::server
