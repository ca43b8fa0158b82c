// Hits do not depend on the tree, nor on the order of the triangles, nor on the unit of length.
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::BuildParams;
using render::Hit;
using render::Ray;

std::vector<TestMesh> meshes() {
  TestMesh doubled = soup(300, 5, 3.0F);
  doubled.append(doubled);
  return {soup(800, 1, 2.0F), terrain(20), slivers(200), box_room(6), doubled};
}

TEST(Metamorphic, HitsDoNotDependOnTheTree) {
  for (const TestMesh& mesh : meshes()) {
    const auto reference = build(mesh);
    const auto rays = hard_rays(*reference, mesh, 6000, 31);
    const auto expected = closest(*reference, rays);
    for (const int depth : {0, 1, 8, 48}) {
      for (const double k_i : {0.1, 1.5, 10.0}) {
        for (const int width : {8, 16}) {
          BuildParams params;
          params.max_depth = depth;
          params.k_i = k_i;
          params.leaf_width = width;
          params.max_duplication = depth == 8 ? 1.1 : 8.0;
          const auto tree = build(mesh, params);
          EXPECT_LE(render::build_stats(*tree).depth, depth);
          EXPECT_EQ(count_differences(rays, closest(*tree, rays), expected), 0U)
              << "depth " << depth << " k_i " << k_i << " width " << width;
        }
      }
    }
  }
}

TEST(Metamorphic, CountersDependOnTheTreeAlone) {
  const TestMesh mesh = terrain(40);
  const auto tree = build(mesh);
  const auto rays = hard_rays(*tree, mesh, 4096, 32);
  std::vector<Hit> hits(rays.size());
  render::TraversalCounters whole;
  render::closest_hits(*tree, rays, hits, {}, render::Traversal::kTree, &whole);
  render::TraversalCounters parts;
  const std::span<const Ray> all(rays);
  for (std::size_t i = 0; i < rays.size(); i += 100) {
    const auto piece = all.subspan(i, std::min<std::size_t>(100, rays.size() - i));
    render::closest_hits(*tree, piece, hits, {}, render::Traversal::kTree, &parts);
  }
  EXPECT_EQ(whole.calls, 1U);
  EXPECT_EQ(parts.calls, 41U);
  EXPECT_EQ(whole.rays, rays.size());
  EXPECT_EQ(parts.rays, whole.rays);
  EXPECT_EQ(parts.node_steps, whole.node_steps);
  EXPECT_EQ(parts.leaf_visits, whole.leaf_visits);
  EXPECT_EQ(parts.block_tests, whole.block_tests);
}

TEST(Metamorphic, ShufflingTrianglesKeepsT) {
  for (const TestMesh& mesh : meshes()) {
    std::vector<std::uint32_t> old;
    const TestMesh other = shuffled(mesh, 33, &old);
    const auto tree = build(mesh);
    const auto rays = hard_rays(*tree, mesh, 6000, 34);
    const auto a = closest(*tree, rays);
    const auto b = closest(*build(other), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(a[i].t, b[i].t) << "ray " << i;
      ASSERT_EQ(a[i].id == render::kNoHit, b[i].id == render::kNoHit);
    }
  }
}

void expect_scaled(const TestMesh& mesh, float scale) {
  TestMesh scaled = mesh;
  for (Vec3f& p : scaled.positions) p *= scale;
  const auto tree = build(mesh);
  const auto scaled_tree = build(scaled);
  EXPECT_EQ(render::build_stats(*tree).sah_cost, render::build_stats(*scaled_tree).sah_cost);
  ASSERT_EQ(tree->nodes.size(), scaled_tree->nodes.size());
  auto rays = hard_rays(*tree, mesh, 6000, 35);
  for (Ray& ray : rays) {
    for (int k = 0; k < 3; ++k) {
      if (std::abs(ray.o[k]) < 0x1p-30F) ray.o[k] = 0.0F;  // one ulp beside 0 cannot be halved
    }
  }
  auto scaled_rays = rays;
  for (Ray& ray : scaled_rays) {
    ray.o *= scale;
    ray.d *= scale;
  }
  EXPECT_EQ(count_differences(rays, closest(*scaled_tree, scaled_rays), closest(*tree, rays)), 0U)
      << "scale " << scale;
}

TEST(Metamorphic, PowersOfTwoScaleBitForBit) {
  for (const TestMesh& mesh : meshes()) {
    for (const float scale : {0x1p-60F, 0x1p-40F, 0.5F, 0x1p40F, 0x1p60F}) {
      expect_scaled(mesh, scale);
    }
  }
}

// Scaling the direction alone divides t by it.
TEST(Metamorphic, TCountsInUnitsOfTheDirection) {
  const TestMesh mesh = soup(800, 1, 2.0F);
  const auto tree = build(mesh);
  auto rays = hard_rays(*tree, mesh, 6000, 36);
  const auto hits = closest(*tree, rays);
  for (Ray& ray : rays) {
    ray.d *= 0x1p-20F;
    ray.t_min *= 0x1p20F;
    ray.t_max *= 0x1p20F;
  }
  const auto scaled = closest(*tree, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(scaled[i].id, hits[i].id);
    ASSERT_EQ(scaled[i].t, hits[i].t * 0x1p20F);  // infinity stays infinity
  }
}

}  // namespace
}  // namespace raykiln::test
