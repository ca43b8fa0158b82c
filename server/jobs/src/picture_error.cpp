#include "raykiln/jobs/picture_error.hpp"

#include <algorithm>

namespace raykiln::server {

void add_point(std::vector<CurvePoint>& curve, const CurvePoint& point) {
  if (curve.size() >= kMostCurvePoints) {
    std::size_t kept = 0;
    for (std::size_t i = 1; i < curve.size(); i += 2) curve[kept++] = curve[i];
    curve.resize(kept);
  }
  curve.push_back(point);
}

std::string_view name(DoneBy value) {
  switch (value) {
    case DoneBy::kSamples: return "samples";
    case DoneBy::kSeconds: return "seconds";
    case DoneBy::kError: return "error";
    case DoneBy::kNone: break;
  }
  return "";
}

DoneBy done_by_named(std::string_view text) {
  for (const DoneBy value : {DoneBy::kSamples, DoneBy::kSeconds, DoneBy::kError}) {
    if (name(value) == text) return value;
  }
  return DoneBy::kNone;
}

bool target_met(const StopRule& rule, const PictureError& error) {
  return rule.error && error.grade == "measured" && error.least_samples >= kErrorFloor &&
         error.error.high <= *rule.error;
}

std::uint64_t next_decision(std::uint64_t samples) {
  return std::max(kErrorFloor, samples + (samples + 19) / 20);
}

double target_fraction(const StopRule& rule, const PictureError& error) {
  if (!rule.error || !error.known() || error.error.high <= 0.0) return 0.0;
  const double ratio = *rule.error / error.error.high;
  return std::min(0.99, ratio * ratio);
}

}  // namespace raykiln::server
