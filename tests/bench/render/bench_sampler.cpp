// How fast do errors fall with samples, by sampler?
// Usage: bench_sampler [SIDE_PX] [SAMPLES] [SEEDS]     JSON: error against samples, slopes, processor seconds
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
  std::vector<std::uint64_t> samples;
  std::vector<double> rel_mse;
  double mean = 0.0, variance = 0.0, seconds_per_sample = 0.0;
};

Curve measure(const PreparedScene& scene, RenderSettings settings, std::uint64_t most, std::uint64_t seeds) {
  const std::size_t values = 3 * static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height);
  Curve curve;
  for (std::uint64_t n = 16; n <= most; n *= 2) curve.samples.push_back(n);
  std::vector<Scatter> scatter(curve.samples.size(), Scatter(values));
  const PixelRect all{0, 0, settings.width, settings.height};
  const std::clock_t start = std::clock();
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    settings.seed = seed;
    Film film = make_film(settings);
    std::uint64_t block = 0, done = 0;
    for (std::size_t k = 0; k < scatter.size(); ++k) {
      std::vector<SampleBlock> blocks;
      for (; done < curve.samples[k]; done = blocks.back().first + blocks.back().count) {
        blocks.push_back(sample_block(block++));
      }
      merge(film, render_tile(scene, settings, all, blocks, {}));
      scatter[k].add(means_of(film));
    }
  }
  const double rendered = static_cast<double>(most * seeds) * static_cast<double>(values) / 3.0;
  curve.seconds_per_sample = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / rendered;
  for (const Scatter& s : scatter) curve.rel_mse.push_back(s.rel_mse());
  curve.mean = scatter.back().mean();
  curve.variance = scatter.back().variance();
  return curve;
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

void print(const char* sampler, const Curve& curve) {
  std::printf("    \"%s\": {\"slope\": %.3f, \"seconds_per_sample\": %.3e, \"rel_mse\": {", sampler, slope(curve),
              curve.seconds_per_sample);
  for (std::size_t k = 0; k < curve.samples.size(); ++k) {
    std::printf("%s\"%llu\": %.4e", k > 0 ? ", " : "", static_cast<unsigned long long>(curve.samples[k]), curve.rel_mse[k]);
  }
  std::printf("}}");
}

bool compare(const BenchScene& s, int side, std::uint64_t samples, std::uint64_t seeds, const char* comma) {
  const auto scene = s.scene().prepare();
  RenderSettings settings;
  settings.width = settings.height = side;
  const Curve random = measure(*scene, settings, samples, seeds);
  settings.sampler = Sampler::kSobol;
  const Curve sobol = measure(*scene, settings, samples, seeds);
  const double apart = std::abs(random.mean - sobol.mean) / std::sqrt(random.variance + sobol.variance);
  std::printf("  {\"scene\": \"%s\",\n", s.name);
  print("random", random);
  std::printf(",\n");
  print("sobol", sobol);
  std::printf(",\n    \"means_apart_in_standard_errors\": %.2f, \"rel_mse_ratio_at_end\": %.3f}%s\n", apart,
              random.rel_mse.back() / sobol.rel_mse.back(), comma);
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
