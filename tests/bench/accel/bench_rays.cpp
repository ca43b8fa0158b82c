// Replays a file of rays through one mesh and writes what each met, so that another program can
// compare ray for ray.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>

#include "bench_report.hpp"
#include "raykiln/accel/kernels.hpp"

static_assert(std::endian::native == std::endian::little, "files hold little-endian floats");

namespace {

using raykiln::bench::Stopwatch;
using raykiln::render::Hit;
using raykiln::render::KdTree;
using raykiln::render::kNoHit;
using raykiln::render::Occlusion;
using raykiln::render::Ray;
using raykiln::render::Traversal;
using raykiln::render::TraversalCounters;
using raykiln::render::TriangleTest;

struct Options {
  std::string scene, rays, mode = "closest", kernel = "tree", test = "watertight", out, json;
  std::size_t triangles = 1'000'000, stream = 4096;
  int repeat = 3;
  std::uint64_t seed = 1;
  raykiln::render::BuildParams params;
};

Traversal traversal_of(const Options& options) {
  const bool fast = options.test == "fast";
  return raykiln::render::with_test(*raykiln::render::traversal_named(options.kernel),
                                    fast ? TriangleTest::kFast : TriangleTest::kWatertight);
}

/// What is written for a ray: 8 bytes.
struct Answer {
  float t;
  std::uint32_t id;
};

std::optional<std::vector<Ray>> read_rays(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return std::nullopt;
  const auto bytes = static_cast<std::size_t>(in.tellg());
  if (bytes % sizeof(Ray) != 0) return std::nullopt;
  std::vector<Ray> rays(bytes / sizeof(Ray));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(rays.data()), static_cast<std::streamsize>(bytes));
  if (!in) return std::nullopt;
  return rays;
}

bool write_answers(const std::string& path, const std::vector<Answer>& answers) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(answers.data()),
            static_cast<std::streamsize>(answers.size() * sizeof(Answer)));
  return out.good();
}

void trace(const KdTree& tree, const Options& options, std::span<const Ray> rays,
           std::span<Answer> answers, TraversalCounters& counters) {
  const Traversal traversal = traversal_of(options);
  if (options.mode == "any") {
    std::vector<Occlusion> found(rays.size());
    raykiln::render::any_hits(tree, rays, found, traversal, &counters);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool blocked = found[i] != Occlusion::kNone;
      answers[i] = {blocked ? 0.0F : std::numeric_limits<float>::infinity(), blocked ? 0U : kNoHit};
    }
  } else {
    std::vector<Hit> hits(rays.size());
    raykiln::render::closest_hits(tree, rays, hits, {}, traversal, &counters);
    for (std::size_t i = 0; i < hits.size(); ++i) answers[i] = {hits[i].t, hits[i].id};
  }
}

int run(const Options& options) {
  const auto mesh = raykiln::bench::make_mesh(options.scene, options.triangles, options.seed);
  const auto rays = read_rays(options.rays);
  if (!mesh || !rays) {
    std::fprintf(stderr, "cannot read %s\n", (mesh ? options.rays : options.scene).c_str());
    return 2;
  }
  raykiln::render::SerialTaskRunner runner;
  const auto tree = raykiln::render::build_kdtree(mesh->view(), options.params, runner);
  std::vector<Answer> answers(rays->size());
  TraversalCounters counters;
  double seconds = std::numeric_limits<double>::infinity();
  for (int r = 0; r < options.repeat; ++r) {
    counters = {};
    const Stopwatch watch;
    for (std::size_t i = 0; i < rays->size(); i += options.stream) {
      const std::size_t n = std::min(options.stream, rays->size() - i);
      trace(*tree, options, std::span(*rays).subspan(i, n), std::span(answers).subspan(i, n),
            counters);
    }
    seconds = std::min(seconds, watch.elapsed().cpu);
  }
  const auto used = raykiln::render::resolve(traversal_of(options));
  const auto hits = std::count_if(answers.begin(), answers.end(),
                                  [](const Answer& a) { return a.id != kNoHit; });
  auto report = raykiln::bench::conditions("bench_rays", 1, options.seed);
  report.add("scene", options.scene)
      .add("triangles", static_cast<std::uint64_t>(mesh->triangles.size()))
      .add("mode", options.mode)
      .add("kernel", std::string(raykiln::render::name(used)))
      .add("rays", static_cast<std::uint64_t>(rays->size()))
      .add("hits", static_cast<std::uint64_t>(hits))
      .add("cpu_seconds", seconds)
      .add("mrays_per_cpu_second", static_cast<double>(rays->size()) / seconds / 1e6)
      .add("node_steps", counters.node_steps)
      .add("leaf_visits", counters.leaf_visits)
      .add("block_tests", counters.block_tests);
  std::printf("%s\n", report.text().c_str());
  if (!options.json.empty() && !raykiln::bench::write_file(options.json, report.text())) return 1;
  if (!options.out.empty() && !write_answers(options.out, answers)) return 1;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Replays a file of rays. RAYS holds 8 little-endian floats a ray: o, t_min, d, t_max. HITS "
      "gets a float t and an unsigned 32-bit triangle id a ray; +inf and 4294967295 for none. In the "
      "mode any, a ray that meets something gets t 0 and id 0.");
  app.add_option("SCENE", options.scene, std::string("mesh: ") + raykiln::bench::kFamilies)
      ->required();
  app.add_option("RAYS", options.rays, "file of rays")->required();
  app.add_option("--mode", options.mode, "closest or any")->check(CLI::IsMember({"closest", "any"}));
  app.add_option("--kernel", options.kernel, "tree stands for the fastest available")
      ->check(CLI::IsMember({"tree", "scalar", "avx2", "avx512", "brute"}));
  app.add_option("--test", options.test, "of triangles: watertight, or fast, in float alone")
      ->check(CLI::IsMember({"watertight", "fast"}));
  app.add_option("--out", options.out, "file for (t, id)");
  app.add_option("--triangles", options.triangles, "of a generated mesh, about")
      ->check(CLI::Range(std::size_t{2}, std::size_t{100'000'000}));
  app.add_option("--leaf-width", options.params.leaf_width, "8 or 16")->check(CLI::IsMember({8, 16}));
  app.add_option("--k-i", options.params.k_i, "cost of a triangle test, for the builder")
      ->check(CLI::PositiveNumber);
  app.add_option("--stream", options.stream, "rays a call")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 24));
  app.add_option("--repeat", options.repeat, "best of this many")->check(CLI::Range(1, 1000));
  app.add_option("--seed", options.seed, "of a generated mesh");
  app.add_option("--json", options.json, "write the figures to this file, too");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
