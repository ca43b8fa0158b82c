// How many rays a second do our kernels trace beside Embree 4, on one thread of the same process?
// The contenders take turns on each set of rays; a ratio is the median over the turns of Embree's
// CPU seconds over ours in that turn, so that a loud neighbour strikes both.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <map>

#include "bench_report.hpp"
#include "embree_library.hpp"
#include "ray_sets.hpp"
#include "raykiln/accel/kernels.hpp"
#include "support/thread_runner.hpp"

namespace {

using raykiln::bench::BenchScene;
using raykiln::bench::EmbreeQuality;
using raykiln::bench::EmbreeScene;
using raykiln::bench::JsonObject;
using raykiln::bench::Seconds;
using raykiln::bench::Stopwatch;
using raykiln::render::Hit;
using raykiln::render::KdTree;
using raykiln::render::kNoHit;
using raykiln::render::Occlusion;
using raykiln::render::Ray;
using raykiln::render::Traversal;
using raykiln::render::TriangleTest;
using raykiln::test::TestMesh;

struct Options {
  std::string embree, json, test = "watertight";
  std::vector<std::string> scenes;
  std::vector<std::string> kernels{"scalar", "avx2", "avx512"};
  raykiln::render::BuildParams params;
  std::uint32_t image = 512;
  std::size_t stream = 4096;
  int repeat = 5;
  int builds = 5;
  int threads = 1;          ///< of builds
  std::uint64_t seed = 1;  ///< of the rays
  [[nodiscard]] bool fast() const { return test == "fast"; }
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One way to trace a set of rays, and the CPU seconds of its turns.
template <typename Answer>
struct Contender {
  std::string name;
  std::function<void(std::span<const Ray>, std::span<Answer>)> trace;
  std::vector<double> seconds{};
  std::vector<Answer> answers{};
};

bool is_hit(const Hit& hit) { return hit.id != kNoHit; }
bool is_hit(Occlusion found) { return found != Occlusion::kNone; }

/// t to 10^-4: Embree and we round differently, and of triangles as near as that either is right.
bool agree(const Hit& a, const Hit& b) {
  if (a.id == b.id) return true;
  return is_hit(a) && is_hit(b) && std::abs(a.t - b.t) <= 1e-4F * std::abs(a.t);
}
bool agree(Occlusion a, Occlusion b) { return is_hit(a) == is_hit(b); }

using Ratios = std::map<std::string, std::vector<double>>;  ///< by "kernel rays", one a scene

class Comparison {
 public:
  Comparison(const Options& options, const BenchScene& scene, const TestMesh& mesh,
             const raykiln::bench::EmbreeLibrary& library, Ratios& ratios)
      : options_(options), scene_(scene), mesh_(mesh), ratios_(ratios) {
    std::vector<double> ours, high, ratio, wall, high_wall, wall_ratio;
    raykiln::test::ThreadRunner runner(options.threads);
    for (int turn = 0; turn < options.builds; ++turn) {
      tree_.reset();
      const Stopwatch our_watch;
      tree_ = raykiln::render::build_kdtree(mesh.view(), options.params, runner);
      const Seconds our_seconds = our_watch.elapsed();
      high_.reset();
      const Stopwatch high_watch;
      high_ = library.build(mesh.view(), EmbreeQuality::kHigh, !options.fast());
      const Seconds high_seconds = high_watch.elapsed();
      ours.push_back(our_seconds.cpu);
      high.push_back(high_seconds.cpu);
      ratio.push_back(our_seconds.cpu / high_seconds.cpu);
      wall.push_back(our_seconds.wall);
      high_wall.push_back(high_seconds.wall);
      wall_ratio.push_back(our_seconds.wall / high_seconds.wall);
    }
    const Stopwatch medium;
    medium_ = library.build(mesh.view(), EmbreeQuality::kMedium, !options.fast());
    const auto& stats = raykiln::render::build_stats(*tree_);
    std::printf("%-9s %zu triangles; build %.3f s, Embree HIGH %.3f s, MEDIUM %.3f s: %.2f of HIGH; "
                "%.0f bytes/triangle\n",
                scene.name, mesh.triangles.size(), median(ours), median(high), medium.elapsed().cpu,
                median(ratio),
                static_cast<double>(stats.bytes) / static_cast<double>(mesh.triangles.size()));
    ratios_["build"].push_back(median(ratio));
    if (options.threads > 1) {
      std::printf("%-9s on %d threads, by the clock %.3f s, Embree HIGH %.3f s: %.2f of HIGH\n", scene.name, options.threads,
                  median(wall), median(high_wall), median(wall_ratio));
      ratios_["build by the clock"].push_back(median(wall_ratio));
    }
    std::fflush(stdout);
  }

  void run() {
    if (!high_ || !medium_ || options_.repeat == 0) return;
    const raykiln::render::Bounds3f box = raykiln::render::bounds(*tree_);
    auto rays = raykiln::bench::primary_rays(
        box, in_mean() ? options_.image : options_.image / 8, options_.seed);
    auto points = raykiln::bench::surface_points(mesh_, rays, closest("primary", rays, true));
    any("shadow", raykiln::bench::shadow_rays(points, box, options_.seed + 2));
    for (const char* kind : {"diffuse 1", "diffuse 2"}) {
      rays = raykiln::bench::cosine_bounces(points, options_.seed + 1);
      points = raykiln::bench::surface_points(mesh_, rays, closest(kind, rays, false));
    }
  }

  std::vector<JsonObject> results;

 private:
  std::vector<Hit> closest(const char* kind, const std::vector<Ray>& rays, bool packets) {
    std::vector<Contender<Hit>> all;
    for (const auto& [name, scene] : {std::pair{"HIGH", high_.get()}, {"MEDIUM", medium_.get()}}) {
      all.push_back({name, [scene = scene](auto r, auto hits) { scene->closest(r, hits); }});
    }
    if (packets) {
      all.push_back({"HIGH x16", [this](auto r, auto hits) { high_->closest16(r, hits); }});
    }
    for (const Traversal kernel : kernels()) {
      all.push_back({std::string(raykiln::render::name(kernel)), [this, kernel](auto r, auto hits) {
                       raykiln::render::closest_hits(*tree_, r, hits, {}, kernel);
                     }});
    }
    return measure(kind, rays, std::move(all));
  }

  void any(const char* kind, const std::vector<Ray>& rays) {
    std::vector<Contender<Occlusion>> all;
    for (const auto& [name, scene] : {std::pair{"HIGH", high_.get()}, {"MEDIUM", medium_.get()}}) {
      all.push_back({name, [scene = scene](auto r, auto found) { scene->any(r, found); }});
    }
    for (const Traversal kernel : kernels()) {
      all.push_back({std::string(raykiln::render::name(kernel)), [this, kernel](auto r, auto found) {
                       raykiln::render::any_hits(*tree_, r, found, kernel);
                     }});
    }
    measure(kind, rays, std::move(all));
  }

  [[nodiscard]] std::vector<Traversal> kernels() const {
    std::vector<Traversal> kernels;
    for (const std::string& kernel : options_.kernels) {
      const auto traversal = raykiln::render::traversal_named(kernel);
      if (!traversal || !raykiln::render::is_available(*traversal)) continue;
      kernels.push_back(raykiln::render::with_test(*traversal, options_.fast() ? TriangleTest::kFast
                                                                               : TriangleTest::kWatertight));
    }
    return kernels;
  }

  template <typename Answer>
  std::vector<Answer> measure(const char* kind, const std::vector<Ray>& rays,
                              std::vector<Contender<Answer>> all) {
    for (auto& one : all) one.answers.resize(rays.size());
    for (int turn = 0; turn < options_.repeat; ++turn) {
      for (auto& one : all) {
        const Stopwatch watch;
        for (std::size_t i = 0; i < rays.size(); i += options_.stream) {
          const std::size_t n = std::min(options_.stream, rays.size() - i);
          one.trace(std::span(rays).subspan(i, n), std::span(one.answers).subspan(i, n));
        }
        one.seconds.push_back(watch.elapsed().cpu);
      }
    }
    const auto& best = median(all[0].seconds) <= median(all[1].seconds) ? all[0] : all[1];
    for (const auto& one : all) report(kind, rays.size(), one, best, all.back());
    return std::move(all.back().answers);
  }

  template <typename Answer>
  void report(const char* kind, std::size_t rays, const Contender<Answer>& one,
              const Contender<Answer>& best, const Contender<Answer>& ours) {
    std::vector<double> turns;
    for (std::size_t i = 0; i < one.seconds.size(); ++i) {
      turns.push_back(best.seconds[i] / one.seconds[i]);
    }
    std::size_t hits = 0;
    std::size_t differing = 0;
    for (std::size_t i = 0; i < rays; ++i) {
      hits += is_hit(one.answers[i]) ? 1U : 0U;
      differing += agree(one.answers[i], ours.answers[i]) ? 0U : 1U;
    }
    const double ratio = median(turns);
    const double mrays = static_cast<double>(rays) / median(one.seconds) / 1e6;
    std::printf("%-9s %-10s %-11s %8zu %8.3f %6.2f %8zu %6zu\n", scene_.name, kind,
                one.name.c_str(), rays, mrays, ratio, hits, differing);
    std::fflush(stdout);
    if (in_mean()) ratios_[one.name + " " + std::string(kind).substr(0, 7)].push_back(ratio);
    results.emplace_back();
    results.back()
        .add("scene", std::string(scene_.name))
        .add("rays_of", std::string(kind))
        .add("contender", one.name)
        .add("rays", static_cast<std::uint64_t>(rays))
        .add("mrays_per_cpu_second", mrays)
        .add("rate_over_faster_embree", ratio)
        .add("hits", static_cast<std::uint64_t>(hits))
        .add("differing", static_cast<std::uint64_t>(differing));
  }

  // Slivers stand apart, and are a hundred times slower.
  [[nodiscard]] bool in_mean() const { return std::string_view(scene_.family) != "sliver"; }

  const Options& options_;
  const BenchScene& scene_;
  const TestMesh& mesh_;
  Ratios& ratios_;
  std::shared_ptr<const KdTree> tree_;
  std::unique_ptr<EmbreeScene> high_, medium_;
};

int run(const Options& options) {
  const auto library = raykiln::bench::load_embree(options.embree, options.threads);
  if (!library) return 2;
  std::printf("Embree %s, robust %s; ratio: rate over that of the faster of HIGH and MEDIUM; apart: "
              "rays where the answer is not that of our last kernel\n"
              "scene     rays of    of              rays   Mray/s  ratio     hits  apart\n",
              library->version().c_str(), options.fast() ? "off" : "on");
  Ratios ratios;
  std::vector<JsonObject> results;
  for (const BenchScene& scene : raykiln::bench::kBenchScenes) {
    const auto& wanted = options.scenes;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), scene.name) == wanted.end()) {
      continue;
    }
    const auto mesh = raykiln::bench::make_mesh(scene.family, scene.triangles, scene.seed);
    if (!mesh || mesh->triangles.empty()) {
      std::fprintf(stderr, "no mesh %s\n", scene.family);
      return 2;
    }
    Comparison comparison(options, scene, *mesh, *library, ratios);
    comparison.run();
    results.insert(results.end(), comparison.results.begin(), comparison.results.end());
  }
  std::printf("geometric means without sliver, build times with it\n");
  for (const auto& [name, values] : ratios) {
    double sum = 0.0;
    for (const double value : values) sum += std::log(value);
    std::printf("  %-18s %.3f of %zu\n", name.c_str(),
                std::exp(sum / static_cast<double>(values.size())), values.size());
  }
  if (!options.json.empty()) {
    auto report = raykiln::bench::conditions("bench_embree", options.threads, options.seed);
    report.add("embree", library->version())
        .add("robust", std::string(options.fast() ? "off" : "on"))
        .add("rays_per_call", static_cast<std::uint64_t>(options.stream))
        .add("leaf_width", static_cast<std::uint64_t>(options.params.leaf_width))
        .add_raw("results", raykiln::bench::json_list(results));
    if (!raykiln::bench::write_file(options.json, report.text())) return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Rays a second beside Embree 4 on one thread, and seconds of builds. tests/bench/accel/fetch_embree.sh gets the "
      "library.");
  app.add_option("EMBREE", options.embree, "libembree4-*.so.4")->required();
  app.add_option("--scenes", options.scenes, "only these of bench_scenes.hpp")
      ->delimiter(',');
  app.add_option("--kernels", options.kernels, "to compare")
      ->delimiter(',')
      ->check(CLI::IsMember({"scalar", "avx2", "avx512"}));
  app.add_option("--leaf-width", options.params.leaf_width, "8 or 16")->check(CLI::IsMember({8, 16}));
  app.add_option("--max-duplication", options.params.max_duplication, "for the builder")
      ->check(CLI::PositiveNumber);
  app.add_option("--k-i", options.params.k_i, "cost of a triangle test, for the builder")
      ->check(CLI::PositiveNumber);
  app.add_option("--image", options.image, "pixels along a side of the picture")
      ->check(CLI::Range(8, 8192));
  app.add_option("--stream", options.stream, "rays a call")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 24));
  app.add_option("--repeat", options.repeat, "turns of rays; 0: builds only")->check(CLI::Range(0, 1000));
  app.add_option("--builds", options.builds, "turns of builds")->check(CLI::Range(1, 1000));
  app.add_option("--threads", options.threads, "of builds; rays are traced on one")->check(CLI::Range(1, 256));
  app.add_option("--seed", options.seed, "of the rays");
  app.add_option("--test", options.test,
                 "watertight: ours beside Embree with its robust flag; fast: both without")
      ->check(CLI::IsMember({"watertight", "fast"}));
  app.add_option("--json", options.json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
