// K04, K08: hair, and one giant beside a million tiny triangles.
#include <sys/resource.h>

#include "hard/support/build_work.hpp"
#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"
#include "hard/support/turns.hpp"

namespace raykiln::hard {
namespace {

using render::build_stats;
using test::build;

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// ---- K04: needles of length 1 and width 1e-3 ----

TEST(K04_Needles, StopAtTheBudget) {
  Row row("K04", "N = 1e3, 1e4, 1e5 needles of length 1, width 1e-3, in the unit cube; budgets 1.5 to 8",
          "references within the budget, said when reached; hits equal brute force");
  TestRandom random(401);
  Tally total;
  for (const auto& [n, budget] : {std::pair{1000U, 8.0}, {1000U, 1.5}, {10'000U, 4.0},
                                 {10'000U, 2.0}, {100'000U, 4.0}}) {
    const TestMesh mesh = test::slivers(n, 40 + n);
    render::BuildParams params;
    params.max_duplication = budget;
    const auto tree = build(mesh, params);
    const auto& stats = build_stats(*tree);
    const double references = static_cast<double>(stats.references) / n;
    EXPECT_LE(references, budget) << n;
    EXPECT_TRUE(stats.splits_over_budget > 0 || references < budget) << n;
    if (n == 100'000U) {
      row.measured("N 1e5: references/N", references);
      row.measured("budget reached", stats.splits_over_budget > 0 ? "yes" : "no");
      row.measured("tree MB", static_cast<double>(stats.bytes) / 1048576.0);
    }
    const std::uint64_t rays = trials(10'000, 10'000);
    total += trace_and_compare(*tree, rays, rays, [&] {
      return test::ray_to(random.in_box(-0.5F, 1.5F),
                          test::point_on(random, mesh.corners(random.below(n))));
    });
  }
  row.measured("peak MB of the process", peak_megabytes());
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.mismatches, 0U);
}

TEST(K04_Needles, BuildTimeGrowth) {
  constexpr double kMost = 3.2;
  Row row("K04", "needles, N = 1e4, 2e4, 4e4, 8e4", "T(2N)/T(N) <= 3.2, of counted work and of time");
  double most_work = 0.0, most_time = 0.0;
  for (const std::size_t n : {10'000U, 20'000U, 40'000U}) {
    const TestMesh once = test::slivers(n, 41), twice = test::slivers(2 * n, 41);
    most_work = std::max(most_work, work_of(build_stats(*build(twice))) / work_of(build_stats(*build(once))));
    Turns turns;
    while (!turns.enough(2, 40, kMost)) turns.group(1, [&] { build(once); }, [&] { build(twice); });
    most_time = std::max(most_time, turns.ratio());
  }
  row.measured("largest ratio of work", most_work);
  row.measured("of time", most_time);
  EXPECT_LE(most_work, kMost);
  EXPECT_LE(most_time, kMost);
}

// ---- K08: one giant and a million tiny ----

struct Stadium {
  TestMesh mesh;
  Vec3f centre;
};

// A quad of 2e6 on a side in y = 0 and n triangles of edge 1e-3 in a cube of 1, all times `unit`.
Stadium stadium(std::uint32_t n, float unit, std::uint64_t seed) {
  Stadium s;
  s.centre = unit * Vec3f(1000.0F, 1.0F, 0.0F);
  const float half = 1e6F * unit;
  s.mesh.add({-half, 0, -half}, {half, 0, -half}, {half, 0, half});
  s.mesh.add({-half, 0, -half}, {half, 0, half}, {-half, 0, half});
  TestRandom random(seed);
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3f p = s.centre + unit * random.in_box(-0.5F, 0.5F);
    s.mesh.add(p, p + 1e-3F * unit * random.direction(), p + 1e-3F * unit * random.direction());
  }
  return s;
}

// Median of triangles tested a ray, from blocks tested and how full they are.
double median_tested(const KdTree& tree, const std::function<Ray()>& make) {
  const double filled = static_cast<double>(build_stats(tree).references) /
                        static_cast<double>(tree.blocks8.size());
  std::vector<double> tested;
  for (int i = 0; i < 2001; ++i) {
    const Ray ray = make();
    Hit hit;
    render::TraversalCounters counters;
    render::closest_hits(tree, std::span(&ray, 1), std::span(&hit, 1), {}, render::Traversal::kTree,
                         &counters);
    tested.push_back(filled * static_cast<double>(counters.block_tests));
  }
  std::nth_element(tested.begin(), tested.begin() + 1000, tested.end());
  return tested[1000];
}

TEST(K08_GiantAndTiny, RaysIntoTheClusterWithDearTests) {
  Row row("K08", "the same with 3e5 triangles, k_i = 4 k_t instead of 0.25 k_t",
          "median triangles tested a ray <= 50");
  TestRandom random(802);
  const Stadium s = stadium(300'000, 1.0F, 80);
  render::BuildParams params;
  params.k_i = 4.0;
  const auto tree = build(s.mesh, params);
  const double tested = median_tested(*tree, [&] {
    return test::ray_to(s.centre + Vec3f(0.0F, 3.0F, 10.0F), s.centre + random.in_box(-0.5F, 0.5F));
  });
  row.measured("median tested", tested);
  row.measured("depth", static_cast<std::uint64_t>(build_stats(*tree).depth));
  EXPECT_LE(tested, 50.0);
}

TEST(K08_GiantAndTiny, RaysIntoTheCluster) {
  Row row("K08", "quad of 2e6 m and 1e6 triangles of 1 mm in a cube of 1 m at (1000,1,0); smaller "
          "members with 1e5 at 2^-20 and 2^20 of the size",
          "median triangles tested a ray <= 50; hits equal brute force; build finishes");
  TestRandom random(801);
  Tally total;
  const std::uint32_t most = tests::kSanitized ? 100'000 : 1'000'000;
  for (const auto& [n, unit] : {std::pair{most, 1.0F}, {most / 10, 0x1p-20F}, {most / 10, 0x1p20F}}) {
    const Stadium s = stadium(n, unit, 80);
    const double start = cpu_seconds();
    const auto tree = build(s.mesh);
    const double seconds = cpu_seconds() - start;
    // Camera rays: from 10 m away through the cluster.
    const auto make = [&] {
      return test::ray_to(s.centre + unit * Vec3f(0.0F, 3.0F, 10.0F) ,
                          s.centre + unit * random.in_box(-0.5F, 0.5F));
    };
    const auto& stats = build_stats(*tree);
    const double tested = median_tested(*tree, make);
    row.measured("N " + std::to_string(n) + ": median tested", tested);
    row.measured("depth", static_cast<std::uint64_t>(stats.depth));
    row.measured("build s", seconds);
    // Not kept with the default costs: four tests a step (blocks of eight are tested at once) stop
    // the builder at leaves of some six triangles: a tree that keeps the promise takes twice the time and four times
    // the memory for the same rays (renderer/accel/README.md). RaysIntoTheClusterWithDearTests is the contrast.
    row.falls_short();
    EXPECT_LE(tested, 500.0);
    const std::uint64_t rays = n == most ? trials(300, 1000) : 1000;
    total += trace_and_compare(*tree, rays, rays, make);
  }
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.mismatches, 0U);
}

}  // namespace
}  // namespace raykiln::hard
