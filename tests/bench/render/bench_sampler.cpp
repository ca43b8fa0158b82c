// How fast do errors fall with samples and with processor time, by sampler?
// Usage: bench_sampler [SIDE_PX] [SAMPLES] [SEEDS]     JSON: error against samples and seconds, slopes, gain at equal time
//        bench_sampler SIDE_PX SAMPLES SCENE SAMPLER   one render without a clock, for callgrind
// relMSE is the scatter of pictures between seeds over (mean^2 + 0.01 M^2): no reference is needed. That both
// samplers have the same limit is checked while it is timed (exit code 3 if not).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "bench/render/picture_scatter.hpp"
#include "support/small_rooms.hpp"

namespace {

using namespace raykiln::render;
using bench::means_of;
using bench::Scatter;

struct BenchScene {
  const char* name;
  support::SceneBuilder (*scene)();
};

/// A box on the ground under a lamp, seen from above: direct light, soft shadows, edges.
support::SceneBuilder box_under_lamp() {
  support::SceneBuilder b;
  support::level_quad(b, {0, -1, 0}, 6.0F, b.material(support::diffuse_material(Rgb(0.6F))));
  support::level_quad(b, {0.5F, 1.5F, 0.5F}, 0.4F, b.material(support::diffuse_material(Rgb(0.0F), support::kLampLight)));
  support::red_box(b);
  b.camera({1.2F, 0.8F, 1.6F}, {-0.35F, -0.8F, -0.35F}, {0, 1, 0}, 0.8F);
  return b;
}

constexpr BenchScene kScenes[] = {{"box_under_lamp", box_under_lamp},
                                  {"diffuse_with_area_light", support::diffuse_with_area_light},
                                  {"glass_with_caustic", support::glass_with_caustic}};

struct Curve {
  explicit Curve(std::uint64_t most, std::size_t values) {
    for (std::uint64_t n = 16; n <= most; n *= 2) samples.push_back(n);
    scatter.assign(samples.size(), Scatter(values));
    seconds.assign(samples.size(), 0.0);
  }
  std::vector<std::uint64_t> samples;
  std::vector<Scatter> scatter;
  std::vector<double> seconds;  ///< of the processor, all seeds together, until so many samples
  std::vector<double> rel_mse;
};

void render_seed(const PreparedScene& scene, const RenderSettings& settings, Curve& curve) {
  Film film = make_film(settings);
  std::uint64_t block = 0, done = 0;
  const std::clock_t start = std::clock();
  for (std::size_t k = 0; k < curve.samples.size(); ++k) {
    std::vector<SampleBlock> blocks;
    for (; done < curve.samples[k]; done = blocks.back().first + blocks.back().count) {
      blocks.push_back(sample_block(block++));
    }
    merge(film, render_tile(scene, settings, {0, 0, settings.width, settings.height}, blocks, {}));
    curve.seconds[k] += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    curve.scatter[k].add(means_of(film));
  }
}

/// Of log relMSE over log samples from 128 on, where all replicates hold as many; 0 without two points.
double slope(const Curve& curve) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < curve.samples.size(); ++k) {
    if (curve.samples[k] < 128) continue;
    const double x = std::log(static_cast<double>(curve.samples[k])), y = std::log(curve.rel_mse[k]);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n < 2 ? 0.0 : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// relMSE that the curve reaches in so many seconds: a power law between its points, beyond them that of the last two.
double rel_mse_in(const Curve& curve, double seconds) {
  std::size_t k = 1;
  while (k + 1 < curve.seconds.size() && curve.seconds[k] < seconds) ++k;
  const double steepness =
      std::log(curve.rel_mse[k] / curve.rel_mse[k - 1]) / std::log(curve.seconds[k] / curve.seconds[k - 1]);
  return curve.rel_mse[k] * std::pow(seconds / curve.seconds[k], steepness);
}

template <class Value>
void print_by_samples(const char* name, const Curve& curve, Value&& value) {
  std::printf("\"%s\": {", name);
  for (std::size_t k = 0; k < curve.samples.size(); ++k) {
    std::printf("%s\"%llu\": %.4e", k > 0 ? ", " : "", static_cast<unsigned long long>(curve.samples[k]), value(k));
  }
  std::printf("}");
}

void print(const char* sampler, const Curve& curve) {
  std::printf("    \"%s\": {\"slope\": %.3f,\n     ", sampler, slope(curve));
  print_by_samples("seconds", curve, [&](std::size_t k) { return curve.seconds[k]; });
  std::printf(",\n     ");
  print_by_samples("rel_mse", curve, [&](std::size_t k) { return curve.rel_mse[k]; });
  std::printf("},\n");
}

bool compare(const BenchScene& s, int side, std::uint64_t samples, std::uint64_t seeds, const char* comma) {
  const auto scene = s.scene().prepare();
  RenderSettings settings;
  settings.width = settings.height = side;
  const std::size_t values = 3 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  Curve random(samples, values), sobol(samples, values);
  // In turns: what else the machine does slows both alike.
  for (settings.seed = 0; settings.seed < seeds; ++settings.seed) {
    settings.sampler = Sampler::kRandom;
    render_seed(*scene, settings, random);
    settings.sampler = Sampler::kSobol;
    render_seed(*scene, settings, sobol);
  }
  for (Curve* curve : {&random, &sobol}) {
    for (const Scatter& scatter : curve->scatter) curve->rel_mse.push_back(scatter.rel_mse());
  }
  const Scatter& a = random.scatter.back();
  const Scatter& b = sobol.scatter.back();
  const double apart = std::abs(a.mean() - b.mean()) / std::sqrt(a.variance() + b.variance());
  std::printf("  {\"scene\": \"%s\",\n", s.name);
  print("random", random);
  print("sobol", sobol);
  std::printf("    ");
  print_by_samples("gain_at_equal_time", random,
                   [&](std::size_t k) { return random.rel_mse[k] / rel_mse_in(sobol, random.seconds[k]); });
  std::printf(",\n    \"seconds_sobol_over_random\": %.3f, \"means_apart_in_standard_errors\": %.2f}%s\n",
              sobol.seconds.back() / random.seconds.back(), apart, comma);
  return apart < 5.0;
}

int one_render(std::string_view name, std::string_view sampler, int side, std::uint64_t samples) {
  for (const BenchScene& s : kScenes) {
    if (s.name != name) continue;
    RenderSettings settings;
    settings.width = settings.height = side;
    if (sampler == "sobol") settings.sampler = Sampler::kSobol;
    const TileResult result = support::render_all(*s.scene().prepare(), settings, samples);
    std::printf("%llu\n", static_cast<unsigned long long>(result.stats.paths));
    return 0;
  }
  std::fprintf(stderr, "no such scene\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::atoi(argv[1]) <= 0) {
    std::puts("usage: bench_sampler [SIDE_PX] [SAMPLES] [SEEDS], or SIDE_PX SAMPLES SCENE random|sobol\n"
              "Error against samples of both samplers over three scenes; JSON. Defaults: 12 1024 16.");
    return std::string_view(argv[1]) == "--help" ? 0 : 2;
  }
  const int side = argc > 1 ? std::atoi(argv[1]) : 12;
  const auto samples = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1024);
  if (argc > 4) return one_render(argv[3], argv[4], side, samples);
  const auto seeds = static_cast<std::uint64_t>(argc > 3 ? std::atoll(argv[3]) : 16);
  bool ok = true;
  std::printf("{\"side_px\": %d, \"seeds\": %llu, \"threads\": 1, \"scenes\": [\n", side, static_cast<unsigned long long>(seeds));
  for (const BenchScene& s : kScenes) {
    ok = compare(s, side, samples, seeds, &s == &kScenes[2] ? "" : ",") && ok;
  }
  std::printf("]}\n");
  return ok ? 0 : 3;
}
