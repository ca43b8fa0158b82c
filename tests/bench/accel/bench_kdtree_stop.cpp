// How soon does a build return after it was asked to stop, at any moment of it?
//
// The stop is asked for after k / (moments + 1) of the processor time of a whole build; what is
// measured is the time from there to the return, everything being freed. Processor time is what one
// thread needs; with more threads wall time counts.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <memory>

#include "bench_report.hpp"
#include "support/thread_runner.hpp"

namespace {

using raykiln::bench::Seconds;
using raykiln::bench::Stopwatch;
using raykiln::render::TaskRunner;

struct Options {
  std::string family = "terrain";
  std::size_t size = 2'000'000;
  int moments = 9;
  int threads = 1;
  std::uint64_t seed = 1;
  double limit_ms = 100.0;
  std::string json;
};

/// Passes work on, and asks for the stop once `at` seconds have gone by.
class StopAfter final : public TaskRunner {
 public:
  StopAfter(TaskRunner& inner, double at, bool by_cpu) : inner_(inner), at_(at), by_cpu_(by_cpu) {}
  void run(std::span<const std::function<void()>> tasks) override { inner_.run(tasks); }
  [[nodiscard]] int concurrency() const override { return inner_.concurrency(); }
  [[nodiscard]] bool stop_requested() const override { return now() >= at_; }
  [[nodiscard]] double now() const {
    const Seconds elapsed = watch_.elapsed();
    return by_cpu_ ? elapsed.cpu : elapsed.wall;
  }

 private:
  TaskRunner& inner_;
  double at_;
  bool by_cpu_;
  Stopwatch watch_;
};

int run(const Options& options) {
  const auto mesh = raykiln::bench::make_mesh(options.family, options.size, options.seed);
  if (!mesh) {
    std::fprintf(stderr, "unknown family; there are %s\n", raykiln::bench::kFamilies);
    return 2;
  }
  std::unique_ptr<TaskRunner> inner = std::make_unique<raykiln::render::SerialTaskRunner>();
  if (options.threads > 1) inner = std::make_unique<raykiln::test::ThreadRunner>(options.threads);
  const bool by_cpu = options.threads == 1;
  const auto seconds_of = [&](double at) {
    StopAfter runner(*inner, at, by_cpu);
    const bool built = raykiln::render::build_kdtree(mesh->view(), {}, runner) != nullptr;
    return std::pair(runner.now(), built);
  };
  const double whole = seconds_of(std::numeric_limits<double>::infinity()).first;
  std::printf("whole build: %.2f s %s\n", whole, by_cpu ? "(cpu)" : "(wall)");
  std::vector<raykiln::bench::JsonObject> results;
  double worst = 0.0;
  for (int k = 1; k <= options.moments; ++k) {
    const double at = whole * k / (options.moments + 1);
    const auto [returned, built] = seconds_of(at);
    if (built) continue;  // it was quicker this time
    const double ms = 1e3 * (returned - at);
    worst = std::max(worst, ms);
    std::printf("asked at %5.1f %%: returned after %7.2f ms\n", 100.0 * at / whole, ms);
    results.emplace_back();
    results.back().add("asked_at_fraction", at / whole).add("returned_after_ms", ms);
  }
  std::printf("worst: %.2f ms, %s %.0f ms\n", worst, worst <= options.limit_ms ? "within" : "beyond",
              options.limit_ms);
  if (options.json.empty()) return 0;
  auto report = raykiln::bench::conditions("bench_kdtree_stop", options.threads, options.seed);
  report.add("family", options.family)
      .add("triangles", static_cast<std::uint64_t>(options.size))
      .add("whole_seconds", whole)
      .add("worst_ms", worst)
      .add_raw("results", raykiln::bench::json_list(results));
  return raykiln::bench::write_file(options.json, report.text()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Time from asking a build of the kd-tree to stop to its return");
  app.add_option("--family", options.family, std::string("mesh: ") + raykiln::bench::kFamilies);
  app.add_option("--size", options.size, "triangles, about")->capture_default_str();
  app.add_option("--moments", options.moments, "of a build, evenly spaced")->check(CLI::Range(1, 1000));
  app.add_option("--threads", options.threads, "threads of the build")->check(CLI::Range(1, 256));
  app.add_option("--limit-ms", options.limit_ms, "what is meant to be kept")->capture_default_str();
  app.add_option("--seed", options.seed, "of the mesh");
  app.add_option("--json", options.json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
