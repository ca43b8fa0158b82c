#include "json_fields.hpp"
#include "raykiln/app/comparison.hpp"
#include "text_format.hpp"

namespace raykiln::server {
namespace {

constexpr const char* kChannels[] = {"red", "green", "blue"};

std::string triple(const std::array<double, 3>& v) {
  return json_array({json_number(v[0]), json_number(v[1]), json_number(v[2])});
}

std::string evidence_json(const render::Evidence& e) {
  JsonFields f;
  f.text("kind", name(e.kind));
  f.raw("rect", json_array({std::to_string(e.where.x0), std::to_string(e.where.y0),
                            std::to_string(e.where.x1), std::to_string(e.where.y1)}));
  f.number("block_px", e.block_px);
  f.text("channel", kChannels[e.channel]);
  f.number("z", e.z);
  f.number("family_chance", e.family_chance);
  return f.object();
}

std::string noise_json(const Comparison& c) {
  const render::NoiseVerdict& v = c.noise;
  JsonFields f;
  f.number("false_alarms", c.settings.noise.false_alarms);
  f.number("tolerance", c.settings.noise.tolerance);
  f.number("tests", static_cast<double>(v.tests));
  f.raw("strongest", evidence_json(v.strongest));
  std::vector<std::string> regions;
  for (const auto& region : v.regions) regions.push_back(evidence_json(region));
  f.raw("regions", json_array(regions));
  f.number("chi2", v.chi2);
  f.raw("shift", triple(v.shift));
  f.raw("shift_error", triple(v.shift_error));
  f.number("smallest_uniform_change", v.smallest_uniform_change);
  f.number("render_not_finite", static_cast<double>(v.render_not_finite));
  f.number("reference_not_finite", static_cast<double>(v.reference_not_finite));
  return f.object();
}

std::string thresholds_json(const Comparison& c) {
  const render::ThresholdVerdict& v = c.thresholds;
  JsonFields f;
  f.number("absolute", c.settings.thresholds.absolute);
  f.number("relative", c.settings.thresholds.relative);
  f.number("allowed_share", c.settings.thresholds.failing_share);
  f.number("hard_limit", c.settings.thresholds.hard_limit);
  f.number("failing_pixels", static_cast<double>(v.failing_pixels));
  f.number("failing_share", v.failing_share);
  f.number("largest", v.largest);
  f.raw("largest_at", json_array({std::to_string(v.x), std::to_string(v.y)}));
  f.number("unlike_not_finite", static_cast<double>(v.unlike_not_finite));
  return f.object();
}

std::string figures_json(const render::DifferenceFigures& v) {
  JsonFields f;
  f.number("mean_render", v.mean_render);
  f.number("mean_reference", v.mean_reference);
  f.number("mean_absolute", v.mean_absolute);
  f.number("rmse", v.rmse);
  f.number("relmse", v.relmse);
  f.number("largest", v.largest);
  f.number("psnr_db", v.psnr_db);
  return f.object();
}

std::string percent(double share) { return short_number(100.0 * share) + " %"; }

std::string noise_text(const Comparison& c) {
  const render::NoiseVerdict& v = c.noise;
  std::string text = "  noise    mean z^2 " + short_number(v.chi2) + " (1 where only noise is), " +
                     std::to_string(v.tests) + " tests, false alarms at most " +
                     percent(c.settings.noise.false_alarms) + "\n  shift   ";
  for (std::size_t i = 0; i < 3; ++i) {
    text += std::string(i > 0 ? ", " : " ") + kChannels[i] + ' ' + percent(v.shift[i]) + " +- " +
            percent(v.shift_error[i]);
  }
  text += "\n  power    a uniform change of " + percent(v.smallest_uniform_change) +
          " would be found in half of such pairs\n";
  for (const auto& e : v.regions) {
    text += "  differs  " + std::string(kChannels[e.channel]) + ", x " + std::to_string(e.where.x0) + ".." +
            std::to_string(e.where.x1 - 1) + ", y " + std::to_string(e.where.y0) + ".." +
            std::to_string(e.where.y1 - 1) + ", z " + short_number(e.z) + '\n';
  }
  if (c.same_seed) {
    text += "  note     both files name the same seed: their noise is not independent, small changes hide less\n";
  }
  return text;
}

std::string thresholds_text(const Comparison& c) {
  const auto& v = c.thresholds;
  const auto& limits = c.settings.thresholds;
  return "  note     noise was not taken into account" +
         std::string(c.settings.use_thresholds ? "" : ": not both pictures carry error and samples") +
         "\n  pixels   " + std::to_string(v.failing_pixels) + " beyond " + short_number(limits.absolute) + " and " +
         percent(limits.relative) + ": " + percent(v.failing_share) + ", " + percent(limits.failing_share) +
         " may be; largest " + short_number(v.largest) + " at (" + std::to_string(v.x) + ", " +
         std::to_string(v.y) + ")\n";
}

}  // namespace

std::string comparison_json(const Comparison& c) {
  JsonFields f;
  f.text("verdict", c.unreadable ? "unreadable" : c.differs ? "differs" : "same");
  f.text("method", name(c.method));
  f.flag("noise_considered", c.method == ComparisonMethod::kNoise);
  f.text("reason", c.reason);
  f.number("width", c.width);
  f.number("height", c.height);
  f.flag("display_values", c.display_values);
  f.flag("same_seed", c.same_seed);
  if (c.method == ComparisonMethod::kNoise) f.raw("noise", noise_json(c));
  if (c.method == ComparisonMethod::kThresholds) f.raw("thresholds", thresholds_json(c));
  if (c.method != ComparisonMethod::kNone) f.raw("figures", figures_json(c.figures));
  return f.object();
}

std::string comparison_text(const Comparison& c) {
  std::string text = (c.unreadable ? "unreadable: " : c.differs ? "differs: " : "same: ") + c.reason + '\n';
  if (c.method == ComparisonMethod::kNone) return text;
  if (c.method == ComparisonMethod::kNoise) text += noise_text(c);
  if (c.method == ComparisonMethod::kThresholds) text += thresholds_text(c);
  return text + "  figures  rmse " + short_number(c.figures.rmse) + ", relmse " + short_number(c.figures.relmse) +
         ", psnr " + short_number(c.figures.psnr_db) + " dB, mean " + short_number(c.figures.mean_render) +
         " against " + short_number(c.figures.mean_reference) + '\n';
}

}  // namespace raykiln::server
