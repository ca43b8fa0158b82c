#include "raykiln/jobs/picture_error.hpp"

#include <algorithm>
#include <iterator>

namespace raykiln::server {
namespace {

struct Notice {
  std::string_view code, words;
  bool more_samples = false;
};

/// By the codes of the contract (Accuracy.notices).
constexpr Notice kNotices[] = {
    {"unsampled_pixels", "some pixels have no sample: allow more", true},
    {"error_unknown", "too few samples to judge: allow 64 a pixel or more", true},
    {"error_rough", "fewer than 64 samples in a pixel, so the interval may be too narrow: allow more", true},
    {"error_sampled", "judged on a part of the pixels; all of them are when the job ends"},
    {"heavy_tailed", "rare bright samples make up much of the noise, so the error may be larger: allow more", true},
    {"no_variance", "no two samples differ: there is no noise, or light that no sample has found"},
    {"aliasing_not_measured", "samples lie in the middle of their pixels, and aliasing is not measured"},
    {"adaptive", "samples were placed where the error was, for which a small bias is possible"},
};

const Notice* known(std::string_view code) {
  const auto* found = std::find_if(std::begin(kNotices), std::end(kNotices), [&](const Notice& n) { return n.code == code; });
  return found == std::end(kNotices) ? nullptr : found;
}

}  // namespace

std::string remark(std::string_view notice) {
  const Notice* found = known(notice);
  return std::string(found == nullptr ? notice : found->words);
}

bool wants_more_samples(std::string_view notice) {
  const Notice* found = known(notice);
  return found != nullptr && found->more_samples;
}

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
