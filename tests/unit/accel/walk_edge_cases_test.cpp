// Rays that make walks go wrong, on trees where it shows.
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::Hit;
using render::KdTree;
using render::Ray;
using render::TraversalCounters;

std::size_t differences_from_brute_force(const KdTree& tree, const std::vector<Ray>& rays) {
  return count_differences(rays, closest(tree, rays),
                           closest(tree, rays, render::Traversal::kBruteForce));
}

// A triangle listed in both halves is hit beyond the near one; what is nearer lies only in the far
// half: the walk may not end with the first hit it finds.
TEST(WalkEdgeCases, HitOutsideTheCellDoesNotEndTheWalk) {
  TestMesh mesh;
  mesh.add({0.5F, -1, -1}, {2.5F, 1, -1}, {1.5F, 0, 2});
  mesh.add({1.2F, -1, -1}, {1.2F, 1, -1}, {1.2F, 1, 1});
  mesh.add({1.2F, -1, -1}, {1.2F, 1, 1}, {1.2F, -1, 1});
  KdTree tree = *build(mesh);
  ASSERT_EQ(render::build_stats(tree).leaves, 1U) << "the tree below replaces this leaf";
  const auto all = tree.blocks8[0];
  auto only_first = all;
  for (std::size_t lane = 1; lane < 8; ++lane) only_first.id[lane] = render::kNoHit;
  tree.blocks8 = {only_first, all};
  tree.nodes = {render::make_inner(0, 1.0F, 2), render::make_leaf(0, 0), render::make_leaf(1, 0),
                render::make_leaf(1, 1)};
  Ray ray;
  ray.o = Vec3f(0.0F, 0.25F, 0.0F);
  ray.d = Vec3f(1, 0, 0);
  const Hit hit = closest(tree, {ray})[0];
  EXPECT_EQ(hit.t, 1.2F);
  EXPECT_EQ(differences_from_brute_force(tree, {ray}), 0U);
}

TEST(WalkEdgeCases, AllSignPatternsOnAllSplitPlanes) {
  const TestMesh mesh = box_room(4);
  render::BuildParams deep;
  deep.k_i = 3.0;
  const auto tree = build(mesh, deep);
  std::vector<Ray> rays;
  const std::array<float, 4> components{0.0F, -0.0F, 1.0F, -1.0F};
  for (const render::KdNode node : tree->nodes) {
    if (render::is_leaf(node)) continue;
    const float split = render::split_position(node);
    for (const float at : {split, render::next_up(split), render::next_down(split)}) {
      for (int pattern = 0; pattern < 64; ++pattern) {
        Ray ray;
        ray.d = Vec3f(components[static_cast<std::size_t>(pattern % 4)],
                      components[static_cast<std::size_t>(pattern / 4 % 4)],
                      components[static_cast<std::size_t>(pattern / 16)]);
        ray.o = Vec3f(0.1F, 0.5F, -0.25F);
        ray.o[static_cast<int>(render::split_axis(node))] = at;
        rays.push_back(ray);
      }
    }
  }
  ASSERT_GT(rays.size(), 5000U);
  EXPECT_EQ(differences_from_brute_force(*tree, rays), 0U);
}

TEST(WalkEdgeCases, AxisParallelRaysDoNotVisitTheWholeTree) {
  const TestMesh mesh = soup(20'000);
  const auto tree = build(mesh);
  TestRandom random(2);
  std::vector<Ray> straight;
  std::vector<Ray> tilted;
  for (int i = 0; i < 2000; ++i) {
    Ray ray;
    ray.o = random.in_box(0, 1);
    ray.o.z = -1.0F;
    ray.d = Vec3f(0.0F, i % 2 == 0 ? 0.0F : -0.0F, 1.0F);
    straight.push_back(ray);
    ray.d = Vec3f(1e-3F, 1e-3F, 1.0F);
    tilted.push_back(ray);
  }
  std::vector<Hit> hits(straight.size());
  TraversalCounters a;
  TraversalCounters b;
  render::closest_hits(*tree, straight, hits, {}, render::Traversal::kTree, &a);
  render::closest_hits(*tree, tilted, hits, {}, render::Traversal::kTree, &b);
  EXPECT_LE(a.node_steps, 4 * b.node_steps);
}

// The slack of the cells may not swallow the scene when the origin is far away. From a million
// times the scene's size a float t cannot tell points apart that lie 0.06 of it from each other, so
// more cells must be looked at to find the lowest id among equals.
TEST(WalkEdgeCases, FarOriginsDoNotVisitTheWholeTree) {
  const TestMesh mesh = soup(20'000);
  const auto tree = build(mesh);
  TestRandom random(4);
  std::vector<std::uint64_t> steps;
  for (const float distance : {2.0F, 1e4F, 1e6F}) {
    std::vector<Ray> rays;
    for (int i = 0; i < 1000; ++i) {
      rays.push_back(ray_to(distance * random.direction(), random.in_box(0, 1)));
    }
    std::vector<Hit> hits(rays.size());
    TraversalCounters counters;
    render::closest_hits(*tree, rays, hits, {}, render::Traversal::kTree, &counters);
    steps.push_back(counters.node_steps);
    EXPECT_EQ(differences_from_brute_force(*tree, rays), 0U);
  }
  EXPECT_LE(steps[1], steps[0] * 3 / 2);
  EXPECT_LE(steps[2], steps[0] * 20);
}

TEST(WalkEdgeCases, OriginsOnTheRootBox) {
  const TestMesh mesh = box_room(3);
  const auto tree = build(mesh);
  TestRandom random(3);
  std::vector<Ray> rays;
  for (int position = 0; position < 27; ++position) {
    const std::array<int, 3> at{position % 3 - 1, position / 3 % 3 - 1, position / 9 - 1};
    for (int i = 0; i < 500; ++i) {
      Ray ray;
      for (int k = 0; k < 3; ++k) {
        const int where = at[static_cast<std::size_t>(k)];
        ray.o[k] = where == 0 ? random.uniform(-1, 1) : static_cast<float>(where);
      }
      ray.d = random.direction();
      if (i % 3 == 0) ray.d[i / 3 % 3] = 0.0F;
      rays.push_back(ray);
    }
  }
  EXPECT_EQ(differences_from_brute_force(*tree, rays), 0U);
}

TEST(WalkEdgeCases, RaysThatAreNotRaysCostNothing) {
  const TestMesh mesh = soup(2000);
  const auto tree = build(mesh);
  Ray bad;
  bad.d = Vec3f(std::numeric_limits<float>::quiet_NaN());
  const std::vector<Ray> rays(100, bad);
  std::vector<Hit> hits(rays.size());
  TraversalCounters counters;
  render::closest_hits(*tree, rays, hits, {}, render::Traversal::kTree, &counters);
  EXPECT_EQ(counters.rays, 100U);
  EXPECT_EQ(counters.node_steps, 0U);
  EXPECT_EQ(count_hits(hits), 0U);
}

TEST(WalkEdgeCases, AnyHitStopsAtTheFirstOpaqueTriangle) {
  TestMesh mesh;
  for (int i = 0; i < 200; ++i) mesh.append(coplanar_grid(1, 2, static_cast<float>(i)));
  render::BuildParams deep;
  deep.k_i = 3.0;
  const auto tree = build(mesh, deep);
  Ray ray;
  ray.o = Vec3f(0.25F, 0.3F, -1.0F);
  std::array<render::Occlusion, 1> result{};
  TraversalCounters counters;
  render::any_hits(*tree, {&ray, 1}, result, render::Traversal::kTree, &counters);
  EXPECT_EQ(result[0], render::Occlusion::kOpaque);
  EXPECT_LE(counters.leaf_visits, 3U);
}

}  // namespace
}  // namespace raykiln::test
