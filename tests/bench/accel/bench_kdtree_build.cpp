// How long does a build take, how much does it do, and how do both grow with the triangles?
#include <CLI/CLI.hpp>
#include <memory>

#include "bench_report.hpp"
#include "support/thread_runner.hpp"

namespace {

using raykiln::bench::JsonObject;
using raykiln::bench::Seconds;
using raykiln::bench::Stopwatch;
using raykiln::render::BuildParams;
using raykiln::render::BuildStats;
using raykiln::render::TaskRunner;

struct Options {
  std::vector<std::string> families{"terrain", "soup"};
  std::vector<std::size_t> sizes{10'000, 100'000, 1'000'000, 2'000'000};
  BuildParams params;
  int threads = 1;
  int repeat = 1;
  std::uint64_t seed = 1;
  std::string json;
};

struct Point {
  double n = 0.0;
  double operations = 0.0;
  double seconds = 0.0;
};

// Slope of the least-squares line through (log n, log y).
double exponent(const std::vector<Point>& points, double Point::* y) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const Point& p : points) {
    const double lx = std::log(p.n);
    const double ly = std::log(p.*y);
    sx += lx;
    sy += ly;
    sxx += lx * lx;
    sxy += lx * ly;
  }
  const auto n = static_cast<double>(points.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

struct Measured {
  BuildStats stats;
  Seconds best;
};

Measured measure(const raykiln::test::TestMesh& mesh, const Options& options, TaskRunner& runner) {
  Measured result;
  result.best.wall = std::numeric_limits<double>::infinity();
  for (int i = 0; i < options.repeat; ++i) {
    const Stopwatch watch;
    const auto tree = raykiln::render::build_kdtree(mesh.view(), options.params, runner);
    const Seconds seconds = watch.elapsed();
    if (seconds.wall < result.best.wall) result.best = seconds;
    result.stats = raykiln::render::build_stats(*tree);
  }
  return result;
}

JsonObject describe(const std::string& family, const Measured& m, Point& point) {
  const BuildStats& s = m.stats;
  const auto n = static_cast<double>(s.triangles);
  const double operations =
      static_cast<double>(s.events_swept + s.events_moved + s.keys_sorted_passes);
  point = {n, operations, m.best.cpu};
  std::printf("%-8s %9.0f %8.3f %8.3f %8.1f %6.2f %6.2f %6.1f %5d %8.2f %6.2f\n", family.c_str(), n,
              m.best.wall, m.best.cpu, m.best.cpu * 1e9 / (n * std::log2(n)),
              operations / (n * std::log2(n)), static_cast<double>(s.references) / n,
              static_cast<double>(s.bytes) / n, s.depth, s.sah_cost,
              static_cast<double>(s.clips) / n);
  std::fflush(stdout);
  JsonObject object;
  object.add("family", family)
      .add("triangles", s.triangles)
      .add("wall_seconds", m.best.wall)
      .add("cpu_seconds", m.best.cpu)
      .add("operations", operations)
      .add("operations_per_n_lg_n", operations / (n * std::log2(n)))
      .add("events_swept", s.events_swept)
      .add("events_moved", s.events_moved)
      .add("keys_sorted_passes", s.keys_sorted_passes)
      .add("clips", s.clips)
      .add("references", s.references)
      .add("inner_nodes", s.inner_nodes)
      .add("leaves", s.leaves)
      .add("empty_leaves", s.empty_leaves)
      .add("bytes", s.bytes)
      .add("depth", static_cast<std::uint64_t>(s.depth))
      .add("sah_cost", s.sah_cost)
      .add("limited", static_cast<std::uint64_t>(s.budget_reached ? 1 : 0));
  return object;
}

int run(const Options& options) {
  std::unique_ptr<TaskRunner> runner;
  if (options.threads > 1) {
    runner = std::make_unique<raykiln::test::ThreadRunner>(options.threads);
  } else {
    runner = std::make_unique<raykiln::render::SerialTaskRunner>();
  }
  std::printf("family           N   wall s    cpu s ns/NlgN op/NlgN ref/N  B/N   depth  cost clip/N\n");
  std::vector<JsonObject> results;
  std::vector<JsonObject> fits;
  for (const std::string& family : options.families) {
    std::vector<Point> points;
    for (const std::size_t size : options.sizes) {
      const auto mesh = raykiln::bench::make_mesh(family, size, options.seed);
      if (!mesh) {
        std::fprintf(stderr, "unknown family %s; there are %s\n", family.c_str(),
                     raykiln::bench::kFamilies);
        return 2;
      }
      points.emplace_back();
      results.push_back(describe(family, measure(*mesh, options, *runner), points.back()));
    }
    if (points.size() < 2) continue;
    const double by_operations = exponent(points, &Point::operations);
    const double by_time = exponent(points, &Point::seconds);
    std::printf("%-8s exponent: operations %.3f, cpu time %.3f\n", family.c_str(), by_operations,
                by_time);
    fits.emplace_back();
    fits.back().add("family", family).add("operations", by_operations).add("cpu_time", by_time);
  }
  if (options.json.empty()) return 0;
  auto report = raykiln::bench::conditions("bench_kdtree_build", options.threads, options.seed);
  report.add("k_t", options.params.k_t)
      .add("k_i", options.params.k_i)
      .add("leaf_width", static_cast<std::uint64_t>(options.params.leaf_width))
      .add_raw("exponents", raykiln::bench::json_list(fits))
      .add_raw("results", raykiln::bench::json_list(results));
  return raykiln::bench::write_file(options.json, report.text()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Build time and counted operations of the kd-tree against the number of triangles");
  app.add_option("--families", options.families, std::string("meshes: ") + raykiln::bench::kFamilies)
      ->delimiter(',');
  app.add_option("--sizes", options.sizes, "triangles, about")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{2}, std::size_t{100'000'000}));
  app.add_option("--leaf-width", options.params.leaf_width, "8 or 16")->check(CLI::IsMember({8, 16}));
  app.add_option("--k-t", options.params.k_t, "cost of a step");
  app.add_option("--k-i", options.params.k_i, "cost of a triangle");
  app.add_option("--threads", options.threads, "threads of the build")->check(CLI::Range(1, 256));
  app.add_option("--repeat", options.repeat, "best of this many")->check(CLI::Range(1, 1000));
  app.add_option("--seed", options.seed, "of the meshes");
  app.add_option("--json", options.json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
