// Every walk through the tree finds what brute force finds: t, id, u and v bit for bit.
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::BuildParams;
using render::Hit;
using render::HitOrder;
using render::Occlusion;
using render::Ray;
using render::Traversal;

TestMesh two_scales(std::uint64_t seed) {
  TestMesh mesh;
  TestRandom random(seed);
  for (int i = 0; i < 300; ++i) {
    const float scale = (i & 1) != 0 ? 1e-6F : 1e6F;
    const Vec3f p = scale * random.in_box(-1.0F, 1.0F);
    mesh.add(p, p + scale * random.in_box(-1.0F, 1.0F), p + scale * random.in_box(-1.0F, 1.0F));
  }
  return mesh;
}

TestMesh grid_aligned(std::uint64_t seed) {
  TestMesh mesh;
  TestRandom random(seed);
  const auto lattice = [&] {
    return Vec3f(static_cast<float>(random.below(5)), static_cast<float>(random.below(5)),
                 static_cast<float>(random.below(5)));
  };
  for (int i = 0; i < 400; ++i) {  // flat in one axis, all corners on a 5^3 lattice
    const int axis = i % 3;
    std::array<Vec3f, 3> p{lattice(), lattice(), lattice()};
    p[1][axis] = p[2][axis] = p[0][axis];
    mesh.add(p[0], p[1], p[2]);
  }
  return mesh;
}

TestMesh with_duplicates(std::uint64_t seed) {
  TestMesh mesh = soup(200, seed, 2.0F);
  mesh.append(mesh);
  return shuffled(mesh, seed);
}

TestMesh walls(std::uint64_t seed) {
  TestMesh mesh = box_room(6, 3.0F);
  mesh.append(coplanar_grid(12, 0, 1.7F, 3.0F));
  return shuffled(mesh, seed);
}

TestMesh large_triangles(std::uint64_t seed) { return soup(400, seed, 6.0F); }

struct Family {
  const char* name;
  TestMesh (*make)(std::uint64_t seed);
};

void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }

class BruteForce : public testing::TestWithParam<Family> {};

INSTANTIATE_TEST_SUITE_P(
    Meshes, BruteForce,
    testing::Values(
        Family{"soup", [](std::uint64_t s) { return soup(500, s); }},
        Family{"large", large_triangles}, Family{"grid_aligned", grid_aligned},
        Family{"walls", walls}, Family{"slivers", [](std::uint64_t s) { return slivers(200, s); }},
        Family{"sphere", [](std::uint64_t) { return sphere(24, 12); }},
        Family{"terrain", [](std::uint64_t s) { return terrain(16, s); }},
        Family{"hair", [](std::uint64_t s) { return hair(40, 8, s); }},
        Family{"two_scales", two_scales}, Family{"duplicates", with_duplicates},
        Family{"coplanar", [](std::uint64_t) { return coplanar_grid(12); }}),
    [](const auto& family) { return std::string(family.param.name); });

TEST_P(BruteForce, ClosestHitsAreEqualBitForBit) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const TestMesh mesh = GetParam().make(seed);
    BuildParams params;
    params.leaf_width = seed % 2 == 0 ? 16 : 8;
    if (seed > 4) params.k_i = 4.0;  // a deep tree with many cuts
    const auto tree = build(mesh, params);
    const auto rays = hard_rays(*tree, mesh, 4800, seed);
    for (const render::TriangleTest test : kTriangleTests) {
      const auto expected = closest(*tree, rays, brute_force(test));
      EXPECT_GT(count_hits(expected), rays.size() / 20) << "the rays must meet something";
      for (const Traversal walk : walks(test)) {
        EXPECT_EQ(count_differences(rays, closest(*tree, rays, walk), expected), 0U)
            << render::name(walk) << " seed " << seed;
      }
    }
  }
}

// Goes on from hit to hit, as a ray does that passes through gaps in surfaces.
void expect_same_hits_beyond(const render::KdTree& tree, const std::vector<Ray>& rays,
                             render::TriangleTest test) {
  std::vector<HitOrder> after(rays.size());
  for (int layer = 0; layer < 6; ++layer) {
    std::vector<Hit> walk(rays.size());
    std::vector<Hit> all(rays.size());
    render::closest_hits(tree, rays, all, after, brute_force(test));
    for (const Traversal kernel : walks(test)) {
      render::closest_hits(tree, rays, walk, after, kernel);
      ASSERT_EQ(count_differences(rays, walk, all), 0U) << render::name(kernel) << " layer " << layer;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (all[i].id == render::kNoHit) continue;
      ASSERT_TRUE(all[i].t > after[i].t || (all[i].t == after[i].t && all[i].id > after[i].id));
      after[i] = {all[i].t, all[i].id};
    }
    // The same from the hit itself on, which is how a ray goes on through a gap in a surface.
    auto shorter = rays;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (all[i].id != render::kNoHit) shorter[i].t_min = all[i].t;
    }
    render::closest_hits(tree, rays, all, after, brute_force(test));
    for (const Traversal kernel : walks(test)) {
      render::closest_hits(tree, shorter, walk, after, kernel);
      ASSERT_EQ(count_differences(rays, walk, all), 0U) << render::name(kernel) << " layer " << layer;
    }
  }
}

TEST_P(BruteForce, GoingOnAfterAHitListsTheSameHits) {
  const TestMesh mesh = GetParam().make(7);
  const auto tree = build(mesh);
  const auto rays = hard_rays(*tree, mesh, 1200, 70);
  for (const render::TriangleTest test : kTriangleTests) expect_same_hits_beyond(*tree, rays, test);
}

TEST_P(BruteForce, AnyHitsAgreeWithAndWithoutOpaqueTriangles) {
  const TestMesh mesh = GetParam().make(8);
  std::vector<std::uint8_t> opaque(mesh.triangles.size());
  TestRandom random(9);
  for (auto& flag : opaque) flag = random.below(2) == 0 ? 1 : 0;
  render::SerialTaskRunner runner;
  const auto tree = render::build_kdtree({mesh.positions, mesh.triangles, opaque}, {}, runner);
  const auto rays = hard_rays(*tree, mesh, 4800, 80);
  std::vector<Occlusion> walk(rays.size());
  std::vector<Occlusion> all(rays.size());
  for (const render::TriangleTest test : kTriangleTests) {
    render::any_hits(*tree, rays, all, brute_force(test));
    for (const Traversal kernel : walks(test)) {
      render::any_hits(*tree, rays, walk, kernel);
      EXPECT_EQ(walk, all) << render::name(kernel);
    }
    const auto hits = closest(*tree, rays, render::with_test(Traversal::kTree, test));
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(all[i] == Occlusion::kNone, hits[i].id == render::kNoHit);
    }
  }
}

}  // namespace
}  // namespace raykiln::test
