// What does one sample of one pixel cost, and where does the time go?
// Usage: bench_scene_seconds_per_sample [samples] [side_px] [depth] [physical|seed] [scene folder]
// Scenes: a room with glass, mirror, gloss, a lamp and a point light (38 triangles), the same room
// with a ball of 20000 triangles, and the scene of the folder if one is given. One thread. The answer
// is checked while it is timed: brute force must give the same bytes for a small tile.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include "raykiln/io/import.hpp"
#include "support/scene_pieces.hpp"

namespace {

using namespace raykiln::render;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A ball of 2 n^2 triangles in the free corner of the room.
void add_ball(support::SceneBuilder& b, int n) {
  const auto material = b.material(support::diffuse_material(Rgb(0.6F)));
  const auto at = [&](int i, int j) {
    const double theta = 3.14159265358979 * i / n, phi = 6.28318530717959 * j / n;
    return Vec3f(Vec3d(-0.45, -0.6, 0.35) + 0.3 * Vec3d(std::sin(theta) * std::cos(phi), std::cos(theta),
                                                        std::sin(theta) * std::sin(phi)));
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      b.quad({at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}, material);
    }
  }
}

bool brute_force_agrees(const PreparedScene& scene, RenderSettings settings) {
  const auto blocks = blocks_for(1);
  const PixelRect rect{settings.width / 2, settings.height / 2, settings.width / 2 + 8,
                       settings.height / 2 + 8};
  const TileResult tree = render_tile(scene, settings, rect, blocks, {});
  settings.traversal = Traversal::kBruteForce;
  const TileResult brute = render_tile(scene, settings, rect, blocks, {});
  return tree.blocks[0].planes.planes == brute.blocks[0].planes.planes;
}

/// Tile by tile, as a worker would; returns the JSON object of the scene.
bool measure(const char* name, std::shared_ptr<const Scene> source, const RenderSettings& settings,
             std::uint64_t samples, const char* comma) {
  const Clock::time_point build_start = Clock::now();
  SerialTaskRunner runner;
  const auto tree = build_scene_tree(*source, {}, runner);
  const auto triangles = source->mesh.triangles.size();
  const auto scene = prepare(std::move(source), tree);
  const double build_seconds = seconds_since(build_start);
  const auto blocks = blocks_for(samples);
  RenderStats stats;
  Film film(settings.width, settings.height);
  double slowest_first_block = 0.0;
  const Clock::time_point start = Clock::now();
  const std::clock_t cpu_start = std::clock();
  for (int y = 0; y < settings.height; y += 64) {
    for (int x = 0; x < settings.width; x += 64) {
      const PixelRect tile{x, y, std::min(x + 64, settings.width), std::min(y + 64, settings.height)};
      for (const SampleBlock& block : blocks) {
        const Clock::time_point task = Clock::now();
        const TileResult result = render_tile(*scene, settings, tile, std::span(&block, 1), {});
        if (block.index == 0) slowest_first_block = std::max(slowest_first_block, seconds_since(task));
        add(stats, result.stats);
        merge(film, result);
      }
    }
  }
  const double seconds = seconds_since(start);
  // On a busy machine this one still means something.
  const double cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  const bool agrees = brute_force_agrees(*scene, settings);
  const double pixel_samples =
      static_cast<double>(settings.width) * settings.height * static_cast<double>(samples);
  const auto rays = static_cast<double>(stats.camera_rays + stats.bounce_rays + stats.shadow_rays);
  std::printf(
      "  {\"scene\": \"%s\", \"triangles\": %zu, \"prepare_seconds\": %.6f, \"seconds\": %.6f,\n"
      "   \"seconds_per_pixel_sample\": %.4e, \"cpu_seconds_per_pixel_sample\": %.4e,\n"
      "   \"rays_per_second\": %.4e, \"rays_per_sample\": %.3f,\n"
      "   \"traversal_share\": %.4f, \"shading_share\": %.4f, \"rest_share\": %.4f,\n"
      "   \"slowest_first_block_seconds\": %.6f, \"short_calls_while_many_live\": %llu,\n"
      "   \"non_finite\": %llu, \"brute_force_agrees\": %s}%s\n",
      name, triangles, build_seconds, seconds, seconds / pixel_samples,
      cpu_seconds / pixel_samples, rays / seconds, rays / pixel_samples,
      stats.traversal_seconds / seconds, stats.shading_seconds / seconds,
      1.0 - (stats.traversal_seconds + stats.shading_seconds) / seconds, slowest_first_block,
      static_cast<unsigned long long>(stats.short_calls_while_many_live),
      static_cast<unsigned long long>(stats.non_finite), agrees ? "true" : "false", comma);
  return agrees;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::atoll(argv[1]) <= 0) {
    std::puts("usage: bench_scene_seconds_per_sample [SAMPLES] [SIDE_PX] [MAX_DEPTH] [physical|seed] [SCENE_FOLDER]\n"
              "Seconds for a sample of a pixel, one thread, and where they go; JSON. Defaults: 16 128 8 physical.");
    return std::string_view(argv[1]) == "--help" ? 0 : 2;
  }
  const auto samples = static_cast<std::uint64_t>(argc > 1 ? std::atoll(argv[1]) : 16);
  RenderSettings settings;
  settings.width = settings.height = argc > 2 ? std::atoi(argv[2]) : 128;
  settings.max_depth = argc > 3 ? std::atoi(argv[3]) : 8;
  if (argc > 4 && std::string_view(argv[4]) == "seed") settings.light_model = kSeedModel;
  std::printf("{\"compiler\": \"%s\", \"build\": \"%s\", \"threads\": 1, \"samples\": %llu, "
              "\"side_px\": %d, \"max_depth\": %d, \"light_model\": \"%s\", \"scenes\": [\n",
              RAYKILN_COMPILER, RAYKILN_BUILD_TYPE, static_cast<unsigned long long>(samples),
              settings.width, path_limit(settings), name(settings.light_model).c_str());
  support::SceneBuilder room = support::mixed_room(), ball = support::mixed_room();
  add_ball(ball, 100);
  bool ok = measure("room", std::make_shared<const Scene>(room.scene()), settings, samples, ",");
  const char* folder = argc > 5 ? argv[5] : nullptr;
  ok = measure("room_with_ball", std::make_shared<const Scene>(ball.scene()), settings, samples,
               folder != nullptr ? "," : "") &&
       ok;
  if (folder != nullptr) {
    ImportResult imported = import_scene(DirectoryFiles(folder));
    if (const auto* error = std::get_if<ImportError>(&imported)) {
      std::fprintf(stderr, "%s: %s\n", folder, error->message.c_str());
      return 1;
    }
    auto scene = std::make_shared<const Scene>(std::move(std::get<ImportedScene>(imported).scene));
    ok = measure(folder, scene, settings, samples, "") && ok;
  }
  std::printf("]}\n");
  return ok ? 0 : 1;
}
