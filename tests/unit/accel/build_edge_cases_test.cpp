// Meshes at the borders of what can be built.
#include "raykiln/accel/build_limits.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::BuildParams;
using render::build_stats;

TEST(BuildEdgeCases, NoTriangles) {
  const auto tree = build(TestMesh{});
  EXPECT_TRUE(render::bounds(*tree).empty());
  EXPECT_EQ(build_stats(*tree).nodes, 1U);
  EXPECT_EQ(build_stats(*tree).references, 0U);
  EXPECT_EQ(closest(*tree, {render::Ray{}})[0].id, render::kNoHit);
  std::array<render::Occlusion, 1> occlusion{render::Occlusion::kOpaque};
  const std::array<render::Ray, 1> ray;
  render::any_hits(*tree, ray, occlusion);
  EXPECT_EQ(occlusion[0], render::Occlusion::kNone);
}

TEST(BuildEdgeCases, OneTriangle) {
  TestMesh mesh;
  mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const auto tree = build(mesh);
  EXPECT_EQ(build_stats(*tree).references, 1U);
  const auto rays = hard_rays(*tree, mesh, 2400, 1);
  EXPECT_EQ(count_differences(rays, closest(*tree, rays),
                              closest(*tree, rays, render::Traversal::kBruteForce)), 0U);
}

TEST(BuildEdgeCases, EverythingInOnePointOrOnOneLineIsDropped) {
  TestMesh point;
  TestMesh line;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i);
    point.add(Vec3f(2.0F), Vec3f(2.0F), Vec3f(2.0F));
    line.add({x, 0, 0}, {x + 1, 0, 0}, {x + 7, 0, 0});
  }
  for (const TestMesh& mesh : {point, line}) {
    const auto tree = build(mesh);
    EXPECT_EQ(build_stats(*tree).dropped_degenerate, 1000U);
    EXPECT_EQ(build_stats(*tree).references, 0U);
    EXPECT_TRUE(render::bounds(*tree).empty());
  }
}

TEST(BuildEdgeCases, DegeneratesLeaveNoTrace) {
  const TestMesh clean = terrain(20);
  TestMesh mixed = clean;
  const std::uint32_t far = static_cast<std::uint32_t>(mixed.positions.size());
  mixed.positions.emplace_back(1e9F, 0.0F, 0.0F);
  for (std::uint32_t i = 0; i < 80; ++i) mixed.triangles.push_back({i, i, far});
  const auto a = build(clean);
  const auto b = build(mixed);
  EXPECT_EQ(build_stats(*b).dropped_degenerate, 80U);
  EXPECT_EQ(build_stats(*a).sah_cost, build_stats(*b).sah_cost);
  const auto rays = hard_rays(*a, clean, 4800, 2);
  EXPECT_EQ(count_differences(rays, closest(*b, rays), closest(*a, rays)), 0U);
}

TEST(BuildEdgeCases, IdenticalTrianglesAreOneLeafAndTheLowestIdWins) {
  const TestMesh mesh = identical_triangles(10'000);
  const auto tree = build(mesh);
  EXPECT_LE(build_stats(*tree).nodes, 64U);
  EXPECT_LE(build_stats(*tree).references, 2 * 10'000U);
  const auto rays = hard_rays(*tree, mesh, 1200, 3);
  for (const auto& hit : closest(*tree, rays)) EXPECT_TRUE(hit.id == 0 || hit.id == render::kNoHit);
}

TEST(BuildEdgeCases, ObliqueSheetsStayALeaf) {
  TestMesh mesh;
  for (int i = 0; i < 500; ++i) {
    const float g = 1.0F + 1e-3F * static_cast<float>(i);
    mesh.add({g, 0, 0}, {0, g, 0}, {0, 0, g});
  }
  const auto tree = build(mesh);
  const double leaf = 0.25 * 500;
  EXPECT_NEAR(build_stats(*tree).sah_cost / leaf, 1.0, 0.2);
  const auto rays = hard_rays(*tree, mesh, 2400, 4);
  EXPECT_EQ(count_differences(rays, closest(*tree, rays),
                              closest(*tree, rays, render::Traversal::kBruteForce)), 0U);
}

TEST(BuildEdgeCases, EachLimitThatStopsSplitsIsToldApart) {
  const TestMesh mesh = soup(3000, 7);
  const auto with = [&](int depth, double duplication) {
    BuildParams params;
    params.max_depth = depth;
    params.max_duplication = duplication;
    return build_stats(*build(mesh, params));
  };
  const auto free = with(48, 1024.0);
  EXPECT_EQ(free.splits_over_budget, 0U);
  EXPECT_EQ(free.splits_over_depth, 0U);
  const auto flat = with(5, 1024.0);
  EXPECT_EQ(flat.splits_over_budget, 0U);
  EXPECT_GT(flat.splits_over_depth, 0U);
  const auto poor = with(48, 1.0);
  EXPECT_GT(poor.splits_over_budget, 0U);
  EXPECT_EQ(poor.splits_over_depth, 0U);
}

TEST(BuildEdgeCases, NeedlesStayWithinTheBudget) {
  BuildParams params;
  params.k_i = 1.5;
  for (const double budget : {1.0, 2.0, 4.0}) {
    params.max_duplication = budget;
    const TestMesh mesh = slivers(5000);
    const auto tree = build(mesh, params);
    EXPECT_LE(static_cast<double>(build_stats(*tree).references), budget * 5000.0);
    EXPECT_GT(build_stats(*tree).splits_over_budget, 0U);
    const auto rays = hard_rays(*tree, mesh, 600, 5);
    EXPECT_EQ(count_differences(rays, closest(*tree, rays),
                                closest(*tree, rays, render::Traversal::kBruteForce)), 0U);
  }
}

TEST(BuildEdgeCases, FlatSceneOfOverlappingTriangles) {
  TestMesh mesh = soup(2000, 6, 0.5F);
  for (Vec3f& p : mesh.positions) p.z = 0.0F;
  const auto tree = build(mesh);
  EXPECT_LE(build_stats(*tree).references, 3 * 2000U);
  EXPECT_GT(build_stats(*tree).inner_nodes, 100U);
  const auto rays = hard_rays(*tree, mesh, 2400, 6);
  EXPECT_EQ(count_differences(rays, closest(*tree, rays),
                              closest(*tree, rays, render::Traversal::kBruteForce)), 0U);
}

TEST(BuildEdgeCases, FanAroundOneVertexStopsAndDoesNotLeak) {
  TestMesh mesh;
  constexpr std::uint32_t kBlades = 1600;
  mesh.positions.emplace_back(0.0F);
  for (std::uint32_t i = 0; i < kBlades; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kBlades;
    mesh.positions.emplace_back(static_cast<float>(std::cos(phi)),
                                static_cast<float>(std::sin(phi)), -1.0F);
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kBlades});
  }
  const auto tree = build(mesh);
  EXPECT_LE(static_cast<double>(build_stats(*tree).references), 0.35 * 40.0 * kBlades);
  TestRandom random(7);
  std::vector<render::Ray> rays;
  for (int i = 0; i < 20'000; ++i) {
    rays.push_back(ray_to(0.3F * random.in_box(-1, 1) + Vec3f(0, 0, 1), Vec3f(0.0F)));
  }
  EXPECT_EQ(count_hits(closest(*tree, rays)), rays.size()) << "aimed at the apex";
}

TEST(BuildEdgeCases, HugeCoordinates) {
  for (const float scale : {1e15F, 1e30F, 1e37F}) {
    TestMesh mesh = soup(300, 8, 3.0F);
    for (Vec3f& p : mesh.positions) p *= scale;
    const auto tree = build(mesh);
    EXPECT_GT(build_stats(*tree).inner_nodes, 10U);
    auto rays = hard_rays(*tree, mesh, 2400, 8);
    for (auto& ray : rays) {  // a direction longer than 2^100 counts as infinite
      if (!(render::length(ray.d / scale) < 100.0F)) ray.d = Vec3f(1.0F, 0.5F, 0.25F);
      ray.d /= scale;
      ray.t_max = std::numeric_limits<float>::infinity();
    }
    const auto expected = closest(*tree, rays, render::Traversal::kBruteForce);
    EXPECT_GT(count_hits(expected), 200U) << scale;
    EXPECT_EQ(count_differences(rays, closest(*tree, rays), expected), 0U);
  }
}

TEST(BuildEdgeCases, GiantAndTinySceneIsNotOneLeaf) {
  TestMesh mesh = soup(20'000, 9);
  for (Vec3f& p : mesh.positions) p = p + Vec3f(1000.0F, 1.0F, 0.0F);
  mesh.add({-1e6F, 0, -1e6F}, {1e6F, 0, -1e6F}, {1e6F, 0, 1e6F});
  mesh.add({-1e6F, 0, -1e6F}, {1e6F, 0, 1e6F}, {-1e6F, 0, 1e6F});
  const auto tree = build(mesh);
  TestRandom random(10);
  std::vector<render::Ray> rays;
  for (int i = 0; i < 1000; ++i) {
    rays.push_back(ray_to(Vec3f(1000.5F, 1.5F, 5.0F),
                          Vec3f(1000.0F, 1.0F, 0.0F) + random.in_box(0, 1)));
  }
  std::vector<render::Hit> hits(rays.size());
  render::TraversalCounters counters;
  render::closest_hits(*tree, rays, hits, {}, render::Traversal::kTree, &counters);
  const double tests = static_cast<double>(counters.block_tests) * 8.0 / 1000.0;
  RecordProperty("triangle_tests_per_ray", std::to_string(tests));
  EXPECT_LE(tests, 400.0);
  EXPECT_EQ(count_differences(rays, hits, closest(*tree, rays, render::Traversal::kBruteForce)),
            0U);
}

TEST(BuildEdgeCases, ParametersOutOfRangeAreReplaced) {
  BuildParams params;
  params.k_t = std::numeric_limits<double>::quiet_NaN();
  params.k_i = -1.0;
  params.empty_factor = 1e300;
  params.max_duplication = -5.0;
  params.max_depth = 1 << 30;
  params.leaf_width = 7;
  const TestMesh mesh = soup(500);
  const auto tree = build(mesh, params);
  EXPECT_EQ(tree->params.leaf_width, 8);
  EXPECT_EQ(tree->params.max_depth, render::kMaxKdDepth);
  EXPECT_EQ(build_stats(*tree).references, 500U);
  params.k_i = 1e300;
  params.max_duplication = std::numeric_limits<double>::infinity();
  EXPECT_LE(build_stats(*build(mesh, params)).depth, 8 + static_cast<int>(1.3 * 9));
}

TEST(BuildEdgeCases, OpaqueFlagsAreChecked) {
  const TestMesh mesh = soup(10);
  const std::vector<std::uint8_t> flags(9, 1);
  render::SerialTaskRunner runner;
  EXPECT_THROW(
      {
        const auto tree =
            render::build_kdtree({mesh.positions, mesh.triangles, flags}, {}, runner);
      },
      std::invalid_argument);
}

TEST(BuildMemory, ByteLimitHoldsAndIsReported) {
  const TestMesh mesh = slivers(20'000);
  render::SerialTaskRunner runner;
  const auto limited_to = [&](std::uint64_t bytes) {
    render::BuildLimits limits;
    limits.max_bytes = bytes;
    return render::build_stats(*render::build_kdtree(mesh.view(), {}, runner, limits));
  };
  const auto free = limited_to(0);
  for (const std::uint64_t limit : {std::uint64_t{12} << 20, std::uint64_t{20} << 20}) {
    const auto stats = limited_to(limit);
    EXPECT_LE(stats.live_bytes_peak, limit);
    EXPECT_GE(stats.live_bytes_peak, stats.bytes);
    EXPECT_LT(stats.references, free.references);
    EXPECT_GT(stats.splits_over_budget, 0U);
  }
  // Never more than the limit: what may not hold every triangle once is refused.
  const std::uint64_t least = render::least_bytes(mesh.view(), {});
  const auto poorest = limited_to(least);
  EXPECT_EQ(poorest.references, mesh.triangles.size());
  EXPECT_LE(poorest.live_bytes_peak, least);
  EXPECT_THROW((void)limited_to(least - 1), std::length_error);
  EXPECT_THROW((void)limited_to(1), std::length_error);
  EXPECT_EQ(limited_to(std::uint64_t{1} << 40).references, free.references);
}

}  // namespace
}  // namespace raykiln::test
