// How long does a build take, how much does it do, and how do both grow with the triangles?
#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>

#include "bench_report.hpp"
#include "raykiln/accel/build_limits.hpp"
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
  std::vector<std::string> scenes;
  std::vector<std::size_t> sizes{10'000, 100'000, 1'000'000, 2'000'000};
  BuildParams params;
  raykiln::render::BuildLimits limits;
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
    const auto tree = raykiln::render::build_kdtree(mesh.view(), options.params, runner, options.limits);
    const Seconds seconds = watch.elapsed();
    if (seconds.wall < result.best.wall) result.best = seconds;
    result.stats = raykiln::render::build_stats(*tree);
  }
  return result;
}

/// What to build, once: a size of a family, or a frozen scene.
struct Subject {
  std::string name;
  std::string family;
  std::size_t triangles;
  std::uint64_t seed;
};

double operations_of(const BuildStats& s) {
  return static_cast<double>(s.events_swept + s.events_moved + s.keys_sorted_passes);
}

void print_row(const std::string& name, const Measured& m) {
  const BuildStats& s = m.stats;
  const auto n = static_cast<double>(s.triangles);
  const double n_lg_n = n * std::log2(n);
  std::printf("%-9s %9.0f %8.3f %8.3f %6.2f %7.1f %6.2f %6.2f %6.1f %6.1f %5d %8.2f %6.2f\n",
              name.c_str(), n, m.best.wall, m.best.cpu, n / m.best.wall * 1e-6,
              m.best.cpu * 1e9 / n_lg_n, operations_of(s) / n_lg_n,
              static_cast<double>(s.references) / n, static_cast<double>(s.bytes) / n,
              static_cast<double>(s.live_bytes_peak) / n, s.depth, s.sah_cost,
              static_cast<double>(s.clips) / n);
  std::fflush(stdout);
}

JsonObject describe(const std::string& name, const Measured& m) {
  const BuildStats& s = m.stats;
  const auto n = static_cast<double>(s.triangles);
  JsonObject object;
  object.add("mesh", name)
      .add("triangles", s.triangles)
      .add("wall_seconds", m.best.wall)
      .add("cpu_seconds", m.best.cpu)
      .add("triangles_per_second", n / m.best.wall)
      .add("operations", operations_of(s))
      .add("operations_per_n_lg_n", operations_of(s) / (n * std::log2(n)))
      .add("events_swept", s.events_swept)
      .add("events_moved", s.events_moved)
      .add("keys_sorted_passes", s.keys_sorted_passes)
      .add("clips", s.clips)
      .add("references", s.references)
      .add("inner_nodes", s.inner_nodes)
      .add("leaves", s.leaves)
      .add("empty_leaves", s.empty_leaves)
      .add("bytes", s.bytes)
      .add("bytes_per_triangle", static_cast<double>(s.bytes) / n)
      .add("live_bytes_peak", s.live_bytes_peak)
      .add("depth", static_cast<std::uint64_t>(s.depth))
      .add("sah_cost", s.sah_cost)
      .add("splits_over_budget", s.splits_over_budget)
      .add("splits_over_depth", s.splits_over_depth);
  return object;
}

class Bench {
 public:
  explicit Bench(const Options& options) : options_(options) {
    if (options.threads > 1) {
      runner_ = std::make_unique<raykiln::test::ThreadRunner>(options.threads);
    } else {
      runner_ = std::make_unique<raykiln::render::SerialTaskRunner>();
    }
    std::printf(
        "mesh              N   wall s    cpu s Mtri/s ns/NlgN op/NlgN ref/N   B/N  peak/N depth   "
        "cost clip/N\n");
  }

  /// False when there is no such mesh, or another one than expected.
  bool add(const Subject& subject, std::vector<Point>* points, std::uint64_t expected_hash = 0) {
    const auto mesh = raykiln::bench::make_mesh(subject.family, subject.triangles, subject.seed);
    if (!mesh) {
      std::fprintf(stderr, "no mesh %s; there are %s\n", subject.family.c_str(),
                   raykiln::bench::kFamilies);
      return false;
    }
    const std::uint64_t found_hash = raykiln::bench::mesh_hash(*mesh);
    if (expected_hash != 0 && found_hash != expected_hash) {
      std::fprintf(stderr, "%s is not the frozen mesh\n", subject.name.c_str());
      return false;
    }
    const Measured measured = measure(*mesh, options_, *runner_);
    print_row(subject.name, measured);
    results.push_back(describe(subject.name, measured));
    char hash[20];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(found_hash));
    results.back().add("mesh_hash", std::string(hash));
    if (points != nullptr) {
      points->push_back({static_cast<double>(measured.stats.triangles),
                         operations_of(measured.stats), measured.best.cpu});
    }
    return true;
  }

  void fit(const std::string& family, const std::vector<Point>& points) {
    if (points.size() < 2) return;
    const double by_operations = exponent(points, &Point::operations);
    const double by_time = exponent(points, &Point::seconds);
    std::printf("%-9s exponent: operations %.3f, cpu time %.3f\n", family.c_str(), by_operations,
                by_time);
    fits.emplace_back();
    fits.back().add("family", family).add("operations", by_operations).add("cpu_time", by_time);
  }

  std::vector<JsonObject> results, fits;

 private:
  const Options& options_;
  std::unique_ptr<TaskRunner> runner_;
};

bool measure_scenes(const Options& options, Bench& bench) {
  for (const std::string& name : options.scenes) {
    const auto* scene = raykiln::bench::find_bench_scene(name);
    if (scene == nullptr) {
      std::fprintf(stderr, "no scene %s\n", name.c_str());
      return false;
    }
    const Subject subject{name, scene->family, scene->triangles, scene->seed};
    if (!bench.add(subject, nullptr, scene->hash)) return false;
  }
  return true;
}

bool measure_families(const Options& options, Bench& bench) {
  for (const std::string& family : options.families) {
    std::vector<Point> points;
    for (const std::size_t size : options.sizes) {
      if (!bench.add({family, family, size, options.seed}, &points)) return false;
    }
    bench.fit(family, points);
  }
  return true;
}

int run(const Options& options) {
  Bench bench(options);
  const bool done =
      options.scenes.empty() ? measure_families(options, bench) : measure_scenes(options, bench);
  if (!done) return 2;
  if (options.json.empty()) return 0;
  auto report = raykiln::bench::conditions("bench_kdtree_build", options.threads, options.seed);
  report.add("k_t", options.params.k_t)
      .add("k_i", options.params.k_i)
      .add("leaf_width", static_cast<std::uint64_t>(options.params.leaf_width))
      .add_raw("exponents", raykiln::bench::json_list(bench.fits))
      .add_raw("results", raykiln::bench::json_list(bench.results));
  return raykiln::bench::write_file(options.json, report.text()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Build time and counted operations of the kd-tree against the number of triangles");
  app.add_option("--families", options.families, std::string("meshes: ") + raykiln::bench::kFamilies)
      ->delimiter(',');
  app.add_option("--scenes", options.scenes,
                 "frozen scenes instead: bunny, dragon, room, city, terrain, terrain8m, soup, sliver")
      ->delimiter(',');
  app.add_option("--sizes", options.sizes, "triangles, about")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{2}, std::size_t{100'000'000}));
  app.add_option("--leaf-width", options.params.leaf_width, "8 or 16")->check(CLI::IsMember({8, 16}));
  app.add_option("--max-bytes", options.limits.max_bytes, "of the build; 0: no limit");
  app.add_option("--k-t", options.params.k_t, "cost of a step");
  app.add_option("--k-i", options.params.k_i, "cost of a triangle");
  app.add_option("--threads", options.threads, "threads of the build")->check(CLI::Range(1, 256));
  app.add_option("--repeat", options.repeat, "best of this many")->check(CLI::Range(1, 1000));
  app.add_option("--seed", options.seed, "of the meshes");
  app.add_option("--json", options.json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::length_error& refused) {
    std::fprintf(stderr, "%s\n", refused.what());
    return 2;
  }
}
