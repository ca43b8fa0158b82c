#include "raykiln/render/missing_light.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <span>

#include "raykiln/scene/environment_map.hpp"
#include "tracing.hpp"

namespace raykiln::render {
namespace {

constexpr double kMostProbes = 1024.0, kMostRays = 1e5;
constexpr std::uint64_t kLeastProbes = 16;
constexpr double kWorthSaying = 1e-3;  ///< of the picture's light
constexpr double kCertain = 3.0;       ///< standard errors
constexpr double kTold = 2.0;          ///< standard errors beyond which a size is told as one
constexpr double kRuleOfThree = 3.0;   ///< 0 events in n trials bound the rate by 3/n at 95 %

/// Pairs between two looks at what has been spent, and the most: steps and blocks of the tree, which
/// take tens of nanoseconds each. Where no split of a tree pays, one ray tests every triangle.
constexpr std::size_t kPairsAtOnce = 8;
constexpr std::uint64_t kMostWork = 20'000'000;

/// The numbers below n, each next one far from those before.
std::vector<std::uint64_t> scattered(std::uint64_t n) {
  std::uint64_t step = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(0.618 * static_cast<double>(n)));
  while (std::gcd(step, n) != 1) ++step;
  std::vector<std::uint64_t> order;
  for (std::uint64_t i = 0; i < n; ++i) order.push_back(i * step % n);
  return order;
}

/// Sample 0, 1, ... of pixels spread evenly over the picture, also if only the first few are used.
std::vector<PathStart> spread(const RenderSettings& settings, std::uint64_t probes) {
  const auto width = static_cast<std::uint64_t>(settings.width);
  const std::uint64_t pixels = width * static_cast<std::uint64_t>(settings.height);
  std::vector<PathStart> starts;
  for (const std::uint64_t i : scattered(probes)) {
    const std::uint64_t pixel =
        probes < pixels ? static_cast<std::uint64_t>(static_cast<double>(i) * static_cast<double>(pixels) /
                                                     static_cast<double>(probes))
                        : i % pixels;
    starts.push_back({static_cast<int>(pixel % width), static_cast<int>(pixel / width), i / pixels});
  }
  return starts;
}

/// Traces some of the pairs' samples by one of two settings.
class Probe {
 public:
  Probe(const PreparedScene& scene, const RenderSettings& settings)
      : tracer_(transport_scene(scene), camera_rays(scene, settings),
                path_settings(scene, settings)) {}

  /// Appends a mean over the channels for each start.
  void trace(std::span<const PathStart> starts, std::vector<double>& means) {
    std::vector<PathResult> paths(starts.size());
    static_cast<void>(tracer_.trace(starts, paths, stats_, {}));  // never stopped: few
    for (const PathResult& path : paths) {
      const Rgbd radiance = path.radiance();
      const double mean = (radiance.x + radiance.y + radiance.z) / 3.0;
      means.push_back(std::isfinite(mean) ? mean : 0.0);  // dropped from pictures too
    }
  }
  [[nodiscard]] std::uint64_t work() const { return stats_.traversal.node_steps + stats_.traversal.block_tests; }

 private:
  PathTracer tracer_;
  RenderStats stats_;
};

MissingLight compare(const PreparedScene& scene, const RenderSettings& settings,
                     const RenderSettings& whole, std::uint64_t probes, const std::stop_token& stop) {
  if (probes < 2 || !make_ready(scene, settings, stop) || !make_ready(scene, whole, stop)) return {};
  const std::vector<PathStart> starts = spread(settings, probes);
  Probe some(scene, settings), all(scene, whole);
  std::vector<double> lacking, full;
  for (std::size_t at = 0; at < starts.size() && some.work() + all.work() < kMostWork; at += kPairsAtOnce) {
    const auto part = std::span(starts).subspan(at, std::min(kPairsAtOnce, starts.size() - at));
    some.trace(part, lacking);
    all.trace(part, full);
  }
  if (full.size() < 2) return {};
  MissingLight result{.probes = full.size()};
  const auto n = static_cast<double>(full.size());
  for (std::size_t i = 0; i < full.size(); ++i) {
    result.differing += full[i] != lacking[i] ? 1U : 0U;
    result.mean += full[i] / n;
    result.missing += (full[i] - lacking[i]) / n;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < full.size(); ++i) {
    const double deviation = full[i] - lacking[i] - result.missing;
    squares += deviation * deviation;
  }
  result.standard_error = std::sqrt(squares / (n * (n - 1.0)));
  return result;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100.0 * share);
  return text;
}

double brightest_emitter(const Scene& scene) {
  float largest = 0.0F;
  if (scene.environment) largest = *std::max_element(scene.environment->rgb.begin(), scene.environment->rgb.end());
  for (const std::uint32_t id : scene.mesh.material_ids) {
    const Rgb& e = scene.materials[id].emission;
    largest = std::max({largest, e.x, e.y, e.z});
  }
  return static_cast<double>(largest);
}

/// Are emitters and the environment looked for by shadow rays?
bool samples_emitters(const RenderSettings& settings) {
  return settings.emitter_sampling && !settings.effects.without.contains(Effect::kEmitterSampling);
}

/// Each is a shadow ray at every vertex.
std::size_t lights_without_surface(const Emitters& emitters) {
  return emitters.point_lights().size() + emitters.spot_lights().size() + emitters.directional_lights().size();
}

}  // namespace

std::uint64_t affordable_probes(const PreparedScene& scene, const RenderSettings& settings) {
  const double lights = 2.0 + static_cast<double>(lights_without_surface(scene.emitters()));
  const double of_pair = 2.0 * lights * std::min(path_limit(settings) + 1, 32);
  const auto probes = static_cast<std::uint64_t>(std::min(kMostProbes, kMostRays / of_pair));
  return probes < kLeastProbes ? 0 : probes;
}

MissingLight cut_off_light(const PreparedScene& scene, const RenderSettings& settings,
                           std::uint64_t probes, const std::stop_token& stop) {
  const bool unlimited = settings.light_model.roulette && settings.branches == 1 && path_limit(settings) >= kRouletteLimit;
  if (unlimited) return {};
  RenderSettings cut = settings;
  cut.max_depth = path_limit(settings);
  cut.branches = 1;  // the same mean as many
  RenderSettings whole = cut;
  whole.max_depth = std::max(*cut.max_depth, kRouletteLimit);
  whole.light_model.roulette = true;
  return compare(scene, cut, whole, probes, stop);
}

MissingLight unseen_light(const PreparedScene& scene, const RenderSettings& settings,
                          std::uint64_t probes, const std::stop_token& stop) {
  const bool nothing_to_find = !scene.emitters().has_triangles() && scene.emitters().environment() == nullptr;
  if (samples_emitters(settings) || nothing_to_find) return {};
  RenderSettings alone = settings;
  alone.branches = 1;
  RenderSettings whole = alone;
  whole.emitter_sampling = true;
  whole.effects.without.erase(Effect::kEmitterSampling);
  return compare(scene, alone, whole, probes, stop);
}

std::vector<RenderNotice> missing_light_notices(const PreparedScene& scene,
                                                const RenderSettings& settings, const std::stop_token& stop) {
  std::vector<RenderNotice> notices;
  const std::uint64_t probes = affordable_probes(scene, settings);
  const MissingLight cut = cut_off_light(scene, settings, probes, stop);
  if (cut.differing > 0 && cut.share() + kTold * cut.share_error() >= kWorthSaying) {
    std::string told = "paths end after ";
    told.append(std::to_string(path_limit(settings))).append(" reflections: ");
    if (cut.missing > kTold * cut.standard_error) {
      told.append(percent(cut.share())).append(" +- ").append(percent(cut.share_error()));
    } else {  // too few probes to tell it from noise: a bound, no figure
      told.append("up to ").append(percent(std::max(0.0, cut.share()) + kTold * cut.share_error()));
    }
    told.append(" of the picture's light is missing, however many samples there are");
    notices.push_back({"truncated_paths", std::move(told)});
  }
  const MissingLight unseen = unseen_light(scene, settings, probes, stop);
  if (unseen.probes > 0 && unseen.missing > kCertain * unseen.standard_error) {
    char most[32];
    std::snprintf(most, sizeof most, "%.3g",
                  kRuleOfThree * brightest_emitter(scene.scene()) / static_cast<double>(unseen.probes));
    notices.push_back({"unseen_light", "paths seldom find the emitters by themselves: " + std::to_string(unseen.probes) +
                                           " of them miss " + percent(unseen.share()) + " +- " +
                                           percent(unseen.share_error()) +
                                           " of the picture's light, where no noise is seen; up to " + most +
                                           " of radiance (3/n of the brightest emitter) may escape as many again"});
  }
  return notices;
}

}  // namespace raykiln::render
