// What does leaving out what a scene does not call for save, against the general code for everything?
// Usage: bench_effects [SIDE_PX] [SAMPLES]            JSON of all named scenes, with times
//        bench_effects SIDE_PX SAMPLES SCENE MODE     one render without a clock, for callgrind
// Checked while it is timed: both give the same bytes (exit code 3 if not).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <vector>

#include "support/effect_scenes.hpp"

namespace {

using namespace raykiln::render;

struct Run {
  double cpu_seconds = 0.0;
  TileResult result;
};

Run render(const PreparedScene& scene, const RenderSettings& settings, std::uint64_t samples) {
  Run run;
  const std::clock_t start = std::clock();
  run.result = support::render_all(scene, settings, samples);
  run.cpu_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return run;
}

std::uint64_t rays(const RenderStats& s) { return s.camera_rays + s.bounce_rays + s.shadow_rays; }

bool same(const TileResult& a, const TileResult& b) {
  for (std::size_t i = 0; i < a.blocks.size(); ++i) {
    if (a.blocks[i].planes.planes != b.blocks[i].planes.planes) return false;
  }
  return true;
}

/// By turns, so that a busy neighbour slows both; the least time of each counts.
bool measure(support::EffectScene s, int side, std::uint64_t samples, const char* comma) {
  constexpr int kTurns = 5;
  s.settings.width = s.settings.height = side;
  const auto scene = s.builder.prepare();
  RenderSettings all = s.settings;
  all.effects.mode = EffectChoice::Mode::kAll;
  double best_all = 1e300, best_auto = 1e300;
  bool equal = true;
  std::uint64_t count = 0;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Run general = render(*scene, all, samples), lean = render(*scene, s.settings, samples);
    best_all = std::min(best_all, general.cpu_seconds);
    best_auto = std::min(best_auto, lean.cpu_seconds);
    equal = equal && same(general.result, lean.result);
    count = rays(lean.result.stats);
  }
  std::printf("  {\"scene\": \"%s\", \"rays\": %llu, \"all_seconds\": %.4f, \"auto_seconds\": %.4f, "
              "\"ratio\": %.3f, \"same_bytes\": %s}%s\n",
              s.name.c_str(), static_cast<unsigned long long>(count), best_all, best_auto,
              best_all / best_auto, equal ? "true" : "false", comma);
  return equal;
}

int one_render(std::string_view name, const char* mode, int side, std::uint64_t samples) {
  const auto choice = effect_choice_of(mode);
  for (support::EffectScene& s : support::named_effect_scenes()) {
    if (s.name != name || !choice) continue;
    s.settings.width = s.settings.height = side;
    s.settings.effects = *choice;
    const TileResult result = support::render_all(*s.builder.prepare(), s.settings, samples);
    std::printf("%llu\n", static_cast<unsigned long long>(rays(result.stats)));
    return 0;
  }
  std::fprintf(stderr, "no such scene or choice of effects\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::atoi(argv[1]) <= 0) {
    std::puts("usage: bench_effects [SIDE_PX] [SAMPLES] [SCENE auto|all|without=...]\n"
              "Processor seconds with all effects and with those that a scene calls for; JSON. Defaults: 96 16.");
    return std::string_view(argv[1]) == "--help" ? 0 : 2;
  }
  const int side = argc > 1 ? std::atoi(argv[1]) : 96;
  const auto samples = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 16);
  if (argc > 4) return one_render(argv[3], argv[4], side, samples);
  const auto scenes = support::named_effect_scenes();
  bool ok = true;
  std::printf("{\"side_px\": %d, \"samples\": %llu, \"threads\": 1, \"scenes\": [\n", side,
              static_cast<unsigned long long>(samples));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    ok = measure(scenes[i], side, samples, i + 1 < scenes.size() ? "," : "") && ok;
  }
  std::printf("]}\n");
  return ok ? 0 : 3;
}
