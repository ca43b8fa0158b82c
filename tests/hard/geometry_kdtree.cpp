// K05, K09 (tree), K10, K11: meshes whose copies, sheets and fans defeat splitting.
#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"

namespace raykiln::hard {
namespace {

using render::build_stats;
using test::build;

Ray ray_from(const Vec3f& o, const Vec3f& d) {
  Ray ray;
  ray.o = o;
  ray.d = d;
  return ray;
}

// ---- K05: exact duplicates ----

TEST(K05_ExactDuplicates, AloneInOneLeaf) {
  Row row("K05", "2, 100, 1e4 copies of an oblique triangle, alone; 1e4 rays at the largest",
          "one leaf of N references, nodes <= 64; the lowest id wins");
  TestRandom random(501);
  std::uint64_t most_nodes = 0, wrong = 0, rays = 0;
  for (const std::size_t n : {2U, 100U, 10'000U, 10'000U}) {
    TestMesh mesh = test::identical_triangles(n);
    if (rays > 0) apply(random_similarity(random, 1.0), mesh);
    const auto tree = build(mesh);
    const auto& stats = build_stats(*tree);
    most_nodes = std::max(most_nodes, stats.nodes);
    EXPECT_EQ(stats.references, n);
    EXPECT_EQ(stats.leaves - stats.empty_leaves, 1U);
    const auto corners = mesh.corners(0);
    const float size = render::length(corners[1] - corners[0]);
    const Vec3f normal = render::normalize(render::cross(corners[1] - corners[0], corners[2] - corners[0]));
    // Not almost in the plane: there a direction that is rounded to floats may pass the triangle by.
    const auto origin = [&] {
      while (true) {
        const Vec3f away = size * random.in_box(-2.0F, 2.0F);
        if (std::abs(render::dot(normal, away)) > 1e-3F * size) return corners[0] + away;
      }
    };
    trace_batches(
        *tree, n > 100 ? trials(10'000, 100'000) : trials(500'000, 5'000'000),
        [&] {
          return test::ray_to(origin(),
                              0.98F * test::point_on(random, corners) +
                                  0.02F * (corners[0] + corners[1] + corners[2]) / 3.0F);
        },
        [&](const auto&, const auto& hits) {
          for (const Hit& hit : hits) wrong += hit.id != 0 ? 1U : 0U;
          rays += hits.size();
        });
  }
  row.measured("nodes", most_nodes);
  row.never("hits that are not the lowest id", wrong, rays);
  EXPECT_LE(most_nodes, 64U);
  EXPECT_EQ(wrong, 0U);
}

TEST(K05_ExactDuplicates, InsideAMesh) {
  Row row("K05", "1e4 and 100 copies of a triangle scattered through the list of a 10k mesh; 50 in one of 200",
          "build ends within the budget; the lowest id wins; hits equal brute force");
  TestRandom random(502);
  Tally total;
  double most = 0.0;
  for (const auto& [n, side] : {std::pair{100U, 71U}, {10'000U, 71U}, {50U, 10U}}) {
    TestMesh mesh = test::terrain(side);
    TestMesh copies = test::identical_triangles(n);
    mesh.append(copies);
    mesh = test::shuffled(mesh, random.bits());
    const auto tree = build(mesh);
    const auto& stats = build_stats(*tree);
    most = std::max(most, static_cast<double>(stats.references) /
                              static_cast<double>(stats.triangles));
    const std::uint64_t rays = side < 71 ? trials(1'000'000, 10'000'000) : trials(10'000, 100'000);
    const std::array<Vec3f, 3> corners{Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1)};
    total += trace_and_compare(*tree, rays, rays, [&] {
      return test::ray_to(random.in_box(-1.0F, 2.0F), test::point_on(random, corners));
    });
  }
  row.measured("references/N", most);
  row.never("differences", total.mismatches, total.compared);
  EXPECT_LE(most, render::BuildParams{}.max_duplication);
  EXPECT_EQ(total.mismatches, 0U);
}

// ---- K09: nothing to build ----

TEST(K09_EmptyScene, TreeOfNothing) {
  Row row("K09", "0 triangles; 1 degenerate triangle; 1 triangle; rays of every kind",
          "build ends; nothing is hit where nothing is");
  TestRandom random(901);
  TestMesh nothing, point, one;
  point.add(Vec3f(1.0F), Vec3f(1.0F), Vec3f(1.0F));
  one.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const auto any_ray = [&] { return ray_from(random.in_box(-2.0F, 2.0F), random.direction()); };
  std::uint64_t hits = 0;
  for (const TestMesh* mesh : {&nothing, &point}) {
    const auto tree = build(*mesh);
    EXPECT_TRUE(render::bounds(*tree).empty());
    hits += trace_and_compare(*tree, 10'000, 10'000, any_ray).hits;
  }
  const auto tree = build(one);
  const Tally away = trace_and_compare(*tree, 10'000, 10'000, [&] {
    return ray_from({random.uniform(), random.uniform(), 1.0F}, {0.0F, 0.0F, 1.0F});
  });
  row.measured("hits", hits + away.hits);
  EXPECT_EQ(hits + away.hits, 0U);
  EXPECT_EQ(away.mismatches, 0U);
}

// ---- K10: oblique sheets ----

TEST(K10_ObliqueSheets, NoSplitPays) {
  Row row("K10", "N = 50, 200, 1e4 parallel triangles (1+ig,0,0),(0,1+ig,0),(0,0,1+ig), g = 1e-3",
          "image correct; the build's figures say that the tree gives no benefit (ratio 1)");
  TestRandom random(1001);
  Tally total;
  for (const std::uint32_t n : {50U, 200U, 10'000U}) {
    TestMesh mesh;
    for (std::uint32_t i = 0; i < n; ++i) {
      const float s = 1.0F + static_cast<float>(i) * 1e-3F;
      mesh.add({s, 0, 0}, {0, s, 0}, {0, 0, s});
    }
    const auto tree = build(mesh);
    const auto& stats = build_stats(*tree);
    const double leaf_cost = tree->params.k_i * static_cast<double>(n);
    row.measured("N " + std::to_string(n) + ": cost/leaf cost", stats.sah_cost / leaf_cost);
    row.measured("nodes", stats.nodes);
    EXPECT_LE(stats.sah_cost, leaf_cost * (1.0 + 1e-9));
    EXPECT_GT(stats.sah_cost, 0.0);
    const std::uint64_t rays = trials(10'000, 100'000);
    total += trace_and_compare(*tree, rays, rays, [&] {
      return ray_from(random.in_box(-0.5F, 2.0F), random.direction());
    });
  }
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_GT(total.hits, total.rays / 30);
}

// ---- K11: fans ----

// N triangles between the apex at 0 and a ring around -z.
TestMesh cone_fan(std::uint32_t n, TestRandom& random) {
  TestMesh mesh;
  mesh.positions.push_back(Vec3f(0.0F));
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * (i + 0.4 * static_cast<double>(random.uniform())) / n;
    mesh.positions.emplace_back(Vec3d(std::cos(a), std::sin(a), -1.0));
  }
  for (std::uint32_t i = 0; i < n; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  return mesh;
}

TestMesh star(std::uint32_t n, TestRandom& random) {
  TestMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3f a = random.direction();
    mesh.add(Vec3f(0.0F), a, a + 0.01F * random.direction());
  }
  return mesh;
}

TEST(K11_Fan, RaysAtTheApexOfAClosedFan) {
  Row row("K11", "cone fans of N = 200, 1600, 1e4 triangles, turned at random; rays at the apex",
          "no leak; references/N <= 0.35 sqrt(N); hits equal brute force");
  TestRandom random(1101);
  Tally total;
  double worst = 0.0;
  const std::uint64_t all = trials(1'000'000, 10'000'000);
  for (const auto& [n, share] : {std::pair{200U, 93U}, {1600U, 6U}, {10'000U, 1U}}) {
    TestMesh mesh = cone_fan(n, random);
    const Similarity turn = random_rotation(random);
    apply(turn, mesh);
    const auto tree = build(mesh);
    const auto& stats = build_stats(*tree);
    worst = std::max(worst, static_cast<double>(stats.references) / n / std::sqrt(n));
    total += trace_and_compare(*tree, all * share / 100, 1000, [&] {
      const float depth = std::pow(10.0F, random.uniform(-3.0F, 3.0F));
      const float r = 0.7F * depth;
      return test::ray_to(turn(Vec3f(random.uniform(-r, r) * 0.7F, random.uniform(-r, r) * 0.7F,
                                     -depth)), Vec3f(0.0F));
    });
  }
  row.never("leaks", total.rays - total.hits, total.rays);
  row.measured("references/N/sqrt(N)", worst);
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.hits, total.rays);
  EXPECT_LE(worst, 0.35);
  EXPECT_EQ(total.mismatches, 0U);
}

TEST(K11_Fan, StarOfNeedles) {
  Row row("K11", "stars of N = 200, 1600, 1e4 needles (0, a, a + 0.01 b), |a| = 1",
          "references/N <= 0.35 sqrt(N); hits equal brute force");
  TestRandom random(1102);
  Tally total;
  double worst = 0.0;
  for (const std::uint32_t n : {200U, 1600U, 10'000U}) {
    const TestMesh mesh = star(n, random);
    const auto tree = build(mesh);
    worst = std::max(worst, static_cast<double>(build_stats(*tree).references) / n / std::sqrt(n));
    const std::uint64_t rays = trials(10'000, 100'000);
    total += trace_and_compare(*tree, rays, rays, [&] {
      return test::ray_to(random.in_box(-1.0F, 1.0F),
                          test::point_on(random, mesh.corners(random.below(n))));
    });
  }
  row.measured("references/N/sqrt(N)", worst);
  row.never("differences", total.mismatches, total.compared);
  EXPECT_LE(worst, 0.35);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_GT(total.hits, total.rays / 2);
}

}  // namespace
}  // namespace raykiln::hard
