// Counted work of trees and walks may only get better: figures without noise, beside those of the
// committed table walk_gates.txt. A figure that is worse by more than 3 % fails.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "bench/accel/bench_scenes.hpp"
#include "bench/accel/ray_sets.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::Hit;
using render::Ray;
using render::Traversal;
using render::TraversalCounters;

using Figures = std::map<std::string, double>;  ///< by "scene rays figure"

constexpr double kTolerance = 0.03;
constexpr const char* kRewrite =
    "RAYKILN_REWRITE_GATES=1 build/test/bin/property_accel --gtest_filter='WalkGates.*'";

Figures read_figures() {
  Figures figures;
  std::ifstream in(RAYKILN_WALK_GATES);
  std::string scene, rays, figure;
  for (double value = 0.0; in >> scene >> rays >> figure >> value;) {
    scene += ' ';
    scene += rays;
    scene += ' ';
    figures[scene + figure] = value;
  }
  return figures;
}

void write_figures(const Figures& figures) {
  std::ofstream out(RAYKILN_WALK_GATES);
  for (const auto& [name, value] : figures) {
    char text[32];
    std::snprintf(text, sizeof text, " %.4g\n", value);
    out << name << text;
  }
}

// Idle lanes a lane at work, so that less is better as with everything else.
double idle_lanes(const TraversalCounters& c) {
  const auto busy = static_cast<double>(c.node_steps + c.leaf_visits);
  return static_cast<double>(c.lane_slots) / busy - 1.0;
}

void add_walk(const std::string& name, const TraversalCounters& c, Figures& figures) {
  const auto rays = static_cast<double>(c.rays);
  figures[name + " steps_per_ray"] = static_cast<double>(c.node_steps) / rays;
  figures[name + " visits_per_ray"] = static_cast<double>(c.leaf_visits) / rays;
  figures[name + " blocks_per_ray"] = static_cast<double>(c.block_tests) / rays;
}

// Closest hits of the rays; their counted work, and the idle lanes of each kernel there is.
std::vector<Hit> measure(const render::KdTree& tree, const std::vector<Ray>& rays,
                         const std::string& name, Figures& figures) {
  std::vector<Hit> hits(rays.size());
  for (const Traversal kernel : {Traversal::kScalar, Traversal::kAvx2, Traversal::kAvx512}) {
    if (!render::is_available(kernel)) continue;
    TraversalCounters counters;
    render::closest_hits(tree, rays, hits, {}, kernel, &counters);
    if (kernel == Traversal::kScalar) {
      add_walk(name, counters, figures);
    } else {
      figures[name + " idle_lanes_" + std::string(render::name(kernel))] = idle_lanes(counters);
    }
  }
  return hits;
}

Figures measured() {
  Figures figures;
  for (const std::string family : {"terrain", "soup", "city", "room"}) {
    const auto mesh = bench::make_mesh(family, 12'000, 1);
    const auto tree = build(*mesh);
    const render::BuildStats& stats = render::build_stats(*tree);
    const auto n = static_cast<double>(stats.triangles);
    figures[family + " tree references_per_triangle"] = static_cast<double>(stats.references) / n;
    figures[family + " tree bytes_per_triangle"] = static_cast<double>(stats.bytes) / n;
    const auto primary = bench::primary_rays(render::bounds(*tree), 64, 1);
    const auto hits = measure(*tree, primary, family + " primary", figures);
    const auto points = bench::surface_points(*mesh, primary, hits);
    measure(*tree, bench::cosine_bounces(points, 2), family + " diffuse", figures);
    const auto shadow = bench::shadow_rays(points, render::bounds(*tree), 3);
    std::vector<render::Occlusion> found(shadow.size());
    TraversalCounters counters;
    render::any_hits(*tree, shadow, found, Traversal::kScalar, &counters);
    add_walk(family + " shadow", counters, figures);
  }
  return figures;
}

TEST(WalkGates, NoFigureIsWorseThanTheTable) {
  const Figures now = measured();
  const Figures table = read_figures();
  if (std::getenv("RAYKILN_REWRITE_GATES") != nullptr) {
    Figures merged = table;  // keeps the figures of kernels that this processor cannot run
    for (const auto& [name, value] : now) merged[name] = value;
    write_figures(merged);
    return;
  }
  bool better = false;
  for (const auto& [name, value] : now) {
    const auto before = table.find(name);
    ASSERT_NE(before, table.end()) << name << " is not in the table";
    EXPECT_LE(value, before->second * (1.0 + kTolerance)) << name;
    if (value < before->second * (1.0 - kTolerance)) {
      std::printf("better: %s %.4g, in the table %.4g\n", name.c_str(), value, before->second);
      better = true;
    }
  }
  if (better) std::printf("keep what is better: %s\n", kRewrite);
}

}  // namespace
}  // namespace raykiln::test
