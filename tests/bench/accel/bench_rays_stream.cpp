// How many rays a second do closest_hits and any_hits do on one thread, with each kernel? Rays of a
// picture: primary ones, two diffuse bounces, and shadow rays. The kernels take turns; all answers
// must be the same bits, and a sample of every class is checked by brute force.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>

#include "bench_report.hpp"
#include "ray_sets.hpp"
#include "raykiln/accel/kernels.hpp"

namespace {

using raykiln::bench::JsonObject;
using raykiln::bench::Stopwatch;
using raykiln::render::BuildParams;
using raykiln::render::Hit;
using raykiln::render::KdTree;
using raykiln::render::kNoHit;
using raykiln::render::Occlusion;
using raykiln::render::Ray;
using raykiln::render::Traversal;
using raykiln::render::TraversalCounters;
using raykiln::test::TestRandom;

struct Options {
  std::vector<std::string> families{"terrain", "soup", "sphere"};
  std::vector<std::string> kernels{"scalar", "avx2", "avx512"};
  std::size_t triangles = 1'000'000;
  BuildParams params;
  std::uint32_t image = 512;
  std::size_t stream = 4096;
  std::size_t check = 200;
  int repeat = 3;
  std::uint64_t seed = 1;
  std::string json, save_rays;
};

/// What one kernel made of one class of rays.
template <typename Answer>
struct Run {
  Traversal kernel;
  double seconds = std::numeric_limits<double>::infinity();  ///< of the processor, best of all
  TraversalCounters counters;
  std::vector<Answer> answers;
};

void query(const KdTree& tree, std::span<const Ray> rays, std::span<Hit> hits, Traversal traversal,
           TraversalCounters* counters) {
  raykiln::render::closest_hits(tree, rays, hits, {}, traversal, counters);
}
void query(const KdTree& tree, std::span<const Ray> rays, std::span<Occlusion> found,
           Traversal traversal, TraversalCounters* counters) {
  raykiln::render::any_hits(tree, rays, found, traversal, counters);
}

class Bench {
 public:
  Bench(const Options& options, const KdTree& tree, std::string family)
      : options_(options), tree_(tree), family_(std::move(family)) {
    for (const std::string& kernel : options.kernels) {
      const auto traversal = raykiln::render::traversal_named(kernel);
      if (traversal && raykiln::render::is_available(*traversal)) kernels_.push_back(*traversal);
    }
  }

  /// Times every kernel on the rays, in turns; gives what the first found.
  template <typename Answer>
  std::vector<Answer> measure(const char* name, const std::vector<Ray>& rays) {
    if (!options_.save_rays.empty()) save(name, rays);
    std::vector<Run<Answer>> runs;
    for (const Traversal kernel : kernels_) runs.push_back({kernel, {}, {}, {}});
    for (auto& run : runs) {
      run.seconds = std::numeric_limits<double>::infinity();
      run.answers.resize(rays.size());
    }
    for (int turn = 0; turn < options_.repeat; ++turn) {
      for (auto& run : runs) time_once(rays, run);
    }
    const std::size_t wrong = count_wrong<Answer>(rays);
    for (const auto& run : runs) {
      std::size_t different = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        different +=
            std::memcmp(&run.answers[i], &runs[0].answers[i], sizeof(Answer)) != 0 ? 1U : 0U;
      }
      report(name, rays.size(), run.kernel, run.seconds, runs[0].seconds, run.counters,
             wrong + different);
    }
    return runs.empty() ? std::vector<Answer>(rays.size()) : std::move(runs[0].answers);
  }

  std::vector<JsonObject> results;
  std::size_t wrong_in_all = 0;

 private:
  /// As bench_rays reads them.
  void save(std::string rays_of, const std::vector<Ray>& rays) const {
    std::replace(rays_of.begin(), rays_of.end(), ' ', '-');
    std::ofstream out(options_.save_rays + "." + rays_of + ".rays", std::ios::binary);
    out.write(reinterpret_cast<const char*>(rays.data()),
              static_cast<std::streamsize>(rays.size() * sizeof(Ray)));
  }

  template <typename Answer>
  void time_once(const std::vector<Ray>& rays, Run<Answer>& run) const {
    const std::span<const Ray> all(rays);
    const Stopwatch watch;
    for (std::size_t i = 0; i < rays.size(); i += options_.stream) {
      const std::size_t n = std::min(options_.stream, rays.size() - i);
      query(tree_, all.subspan(i, n), std::span(run.answers).subspan(i, n), run.kernel,
            &run.counters);
    }
    run.seconds = std::min(run.seconds, watch.elapsed().cpu);
  }

  /// A sample of the rays, every kernel against brute force.
  template <typename Answer>
  [[nodiscard]] std::size_t count_wrong(const std::vector<Ray>& rays) const {
    std::vector<Ray> sample;
    TestRandom random(options_.seed + 99);
    for (std::size_t i = 0; i < options_.check && !rays.empty(); ++i) {
      sample.push_back(rays[random.below(static_cast<std::uint32_t>(rays.size()))]);
    }
    std::vector<Answer> expected(sample.size());
    std::vector<Answer> found(sample.size());
    query(tree_, sample, std::span(expected), Traversal::kBruteForce, nullptr);
    std::size_t wrong = 0;
    for (const Traversal kernel : kernels_) {
      query(tree_, sample, std::span(found), kernel, nullptr);
      for (std::size_t i = 0; i < sample.size(); ++i) {
        wrong += std::memcmp(&expected[i], &found[i], sizeof(Answer)) != 0 ? 1U : 0U;
      }
    }
    return wrong;
  }

  void report(const char* rays_of, std::size_t rays, Traversal kernel, double seconds,
              double first_seconds, const TraversalCounters& counters, std::size_t wrong) {
    const std::string used(raykiln::render::name(kernel));
    const double mrays = static_cast<double>(rays) / seconds / 1e6;
    const auto n = static_cast<double>(std::max<std::uint64_t>(1, counters.rays));
    const auto per_ray = [&](std::uint64_t count) { return static_cast<double>(count) / n; };
    const std::uint64_t visits = counters.node_steps + counters.leaf_visits;
    const double occupancy = counters.lane_slots == 0 ? 0.0
                                                      : static_cast<double>(visits) /
                                                            static_cast<double>(counters.lane_slots);
    const double triangles = per_ray(counters.block_tests) * options_.params.leaf_width;
    const std::size_t slash = family_.rfind('/');
    const std::string shown = family_.substr(slash == std::string::npos ? 0 : slash + 1);
    std::printf("%-12.12s %-10s %-7s %8zu %8.3f %6.2f %7.1f %7.2f %7.2f %7.1f %6.2f %5.2f %6zu\n",
                shown.c_str(), rays_of, used.c_str(), rays, mrays, first_seconds / seconds,
                per_ray(counters.node_steps), per_ray(counters.leaf_visits),
                per_ray(counters.block_tests), triangles, per_ray(counters.exact_tests), occupancy,
                wrong);
    std::fflush(stdout);
    wrong_in_all += wrong;
    results.emplace_back();
    results.back()
        .add("family", family_)
        .add("rays_of", std::string(rays_of))
        .add("kernel", used)
        .add("rays", static_cast<std::uint64_t>(rays))
        .add("mrays_per_cpu_second", mrays)
        .add("rate_over_first_kernel", first_seconds / seconds)
        .add("node_steps_per_ray", per_ray(counters.node_steps))
        .add("leaf_visits_per_ray", per_ray(counters.leaf_visits))
        .add("blocks_per_ray", per_ray(counters.block_tests))
        .add("triangles_per_ray", triangles)
        .add("exact_tests_per_ray", per_ray(counters.exact_tests))
        .add("lane_occupancy", occupancy)
        .add("checked", static_cast<std::uint64_t>(options_.check))
        .add("wrong", static_cast<std::uint64_t>(wrong));
  }

  const Options& options_;
  const KdTree& tree_;
  std::string family_;
  std::vector<Traversal> kernels_;
};

int run(const Options& options) {
  std::printf(
      "mesh         rays of    kernel      rays   Mray/s  ratio nodes/r leaf/r  block/r  tria/r "
      "exact/r lanes  wrong\n");
  std::vector<JsonObject> results;
  std::size_t wrong = 0;
  for (const std::string& family : options.families) {
    const auto mesh = raykiln::bench::make_mesh(family, options.triangles, options.seed);
    if (!mesh) {
      std::fprintf(stderr, "no mesh %s; there are %s\n", family.c_str(),
                   raykiln::bench::kFamilies);
      return 2;
    }
    raykiln::render::SerialTaskRunner runner;
    const auto tree = raykiln::render::build_kdtree(mesh->view(), options.params, runner);
    const raykiln::render::Bounds3f box = raykiln::render::bounds(*tree);
    Bench bench(options, *tree, family);
    auto rays = raykiln::bench::primary_rays(box, options.image, options.seed);
    auto points = raykiln::bench::surface_points(*mesh, rays, bench.measure<Hit>("primary", rays));
    bench.measure<Occlusion>("shadow",
                             raykiln::bench::shadow_rays(points, box, options.seed + 2));
    for (const char* name : {"diffuse 1", "diffuse 2"}) {
      rays = raykiln::bench::cosine_bounces(points, options.seed + 1);
      points = raykiln::bench::surface_points(*mesh, rays, bench.measure<Hit>(name, rays));
    }
    results.insert(results.end(), bench.results.begin(), bench.results.end());
    wrong += bench.wrong_in_all;
  }
  if (!options.json.empty()) {
    auto report = raykiln::bench::conditions("bench_rays_stream", 1, options.seed);
    report.add("triangles", static_cast<std::uint64_t>(options.triangles))
        .add("rays_per_call", static_cast<std::uint64_t>(options.stream))
        .add("leaf_width", static_cast<std::uint64_t>(options.params.leaf_width))
        .add("k_t", options.params.k_t)
        .add("k_i", options.params.k_i)
        .add_raw("results", raykiln::bench::json_list(results));
    if (!raykiln::bench::write_file(options.json, report.text())) return 1;
  }
  return wrong == 0 ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Rays a second of closest_hits and any_hits on one thread, checked by brute force. Exit code "
      "3: a checked ray differed.");
  app.add_option("--families", options.families, std::string("meshes: ") + raykiln::bench::kFamilies)
      ->delimiter(',');
  app.add_option("--kernels", options.kernels, "to compare; ratios are against the first one")
      ->delimiter(',')
      ->check(CLI::IsMember({"scalar", "avx2", "avx512"}));
  app.add_option("--triangles", options.triangles, "of each mesh, about")
      ->check(CLI::Range(std::size_t{2}, std::size_t{100'000'000}));
  app.add_option("--leaf-width", options.params.leaf_width, "8 or 16")->check(CLI::IsMember({8, 16}));
  app.add_option("--k-t", options.params.k_t, "cost of a step, for the builder")
      ->check(CLI::PositiveNumber);
  app.add_option("--k-i", options.params.k_i, "cost of a triangle test, for the builder")
      ->check(CLI::PositiveNumber);
  app.add_option("--image", options.image, "pixels along a side of the picture")
      ->check(CLI::Range(8, 8192));
  app.add_option("--stream", options.stream, "rays a call")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 24));
  app.add_option("--check", options.check, "rays of each class to check by brute force");
  app.add_option("--repeat", options.repeat, "best of this many")->check(CLI::Range(1, 1000));
  app.add_option("--seed", options.seed, "of meshes and rays");
  app.add_option("--save-rays", options.save_rays,
                 "write the rays to PREFIX.<class>.rays, for bench_rays; with one mesh");
  app.add_option("--json", options.json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
