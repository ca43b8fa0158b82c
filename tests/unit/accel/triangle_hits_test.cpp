// One triangle at a time: values, borders, intervals, edge-on rays.
#include <limits>

#include "support/accel_testing.hpp"
#include "triangle_test.hpp"

namespace raykiln::test {
namespace {

using render::Hit;
using render::Ray;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TestMesh unit_triangle() {
  TestMesh mesh;
  mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  return mesh;
}

Ray make_ray(Vec3f o, Vec3f d, float t_min = 0.0F, float t_max = kInf) {
  Ray ray;
  ray.o = o;
  ray.d = d;
  ray.t_min = t_min;
  ray.t_max = t_max;
  return ray;
}

Hit hit_of(const TestMesh& mesh, const Ray& ray) {
  const auto tree = build(mesh);
  const auto walk = closest(*tree, {ray})[0];
  const auto all = closest(*tree, {ray}, render::Traversal::kBruteForce)[0];
  EXPECT_TRUE(same_bits(walk, all));
  return walk;
}

TEST(TriangleHits, GivesDistanceAndBarycentrics) {
  const Hit hit = hit_of(unit_triangle(), make_ray({0.25F, 0.5F, 2.0F}, {0, 0, -4.0F}));
  EXPECT_EQ(hit.id, 0U);
  EXPECT_EQ(hit.t, 0.5F);
  EXPECT_EQ(hit.u, 0.25F);
  EXPECT_EQ(hit.v, 0.5F);
  const Hit back = hit_of(unit_triangle(), make_ray({0.25F, 0.5F, -2.0F}, {0, 0, 1.0F}));
  EXPECT_EQ(back.t, 2.0F);
  EXPECT_EQ(back.u, 0.25F);
}

TEST(TriangleHits, BarycentricsGiveThePoint) {
  TestRandom random(3);
  for (int i = 0; i < 2000; ++i) {
    TestMesh mesh;
    mesh.add(random.in_box(-1, 1), random.in_box(-1, 1), random.in_box(-1, 1));
    const Ray ray = ray_to(random.in_box(-3, 3), point_on(random, mesh.corners(0)));
    const Hit hit = hit_of(mesh, ray);
    if (hit.id == render::kNoHit) continue;  // aimed at the very border
    const auto p = mesh.corners(0);
    const Vec3f by_weights = p[0] * (1.0F - hit.u - hit.v) + p[1] * hit.u + p[2] * hit.v;
    const Vec3f by_distance = ray.o + ray.d * hit.t;
    EXPECT_LE(render::length(by_weights - by_distance), 1e-4F);
    EXPECT_GE(std::min({hit.u, hit.v, 1.0F - hit.u - hit.v}), -1e-6F);
  }
}

TEST(TriangleHits, BordersBelongToTheTriangle) {
  const std::vector<std::array<float, 2>> border{{0, 0},       {1, 0},       {0, 1},
                                                 {0.5F, 0},    {0, 0.5F},    {0.5F, 0.5F},
                                                 {0.25F, 0.75F}};
  for (const auto& p : border) {
    EXPECT_EQ(hit_of(unit_triangle(), make_ray({p[0], p[1], 1}, {0, 0, -1})).id, 0U);
  }
  EXPECT_EQ(hit_of(unit_triangle(), make_ray({-1e-7F, 0.5F, 1}, {0, 0, -1})).id, render::kNoHit);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray({0.5F, 0.5000001F, 1}, {0, 0, -1})).id,
            render::kNoHit);
}

TEST(TriangleHits, IntervalIsClosed) {
  const Vec3f o(0.25F, 0.25F, 1.0F);
  const Vec3f d(0, 0, -1);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, d, 1.0F, 1.0F)).t, 1.0F);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, d, 0.0F, 1.0F)).t, 1.0F);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, d, 1.0F, 9.0F)).t, 1.0F);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, d, 0.0F, render::next_down(1.0F))).id,
            render::kNoHit);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, d, render::next_up(1.0F), 9.0F)).id,
            render::kNoHit);
  EXPECT_EQ(hit_of(unit_triangle(), make_ray({0.25F, 0.25F, 0.0F}, d)).t, 0.0F) << "t_min = 0";
  EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, -d, -kInf, kInf)).t, -1.0F) << "behind";
  const Hit miss = hit_of(unit_triangle(), make_ray(o, -d));
  EXPECT_EQ(miss.t, kInf);
  EXPECT_EQ(miss.id, render::kNoHit);
}

TEST(TriangleHits, EdgeOnRaysMiss) {
  TestRandom random(4);
  for (int i = 0; i < 5000; ++i) {
    Vec3f d = random.direction();
    d.z = (i & 1) != 0 ? 0.0F : -0.0F;
    Vec3f o = random.in_box(-2, 2);
    o.z = i % 3 == 0 ? 0.0F : (i % 3 == 1 ? 1e-45F : -1e-45F);
    EXPECT_EQ(hit_of(unit_triangle(), make_ray(o, d)).id, render::kNoHit);
  }
}

TEST(TriangleHits, RaysThatAreNotRaysMiss) {
  const Vec3f o(0.25F, 0.25F, 1.0F);
  const Vec3f d(0, 0, -1);
  std::vector<Ray> rays{make_ray(o, {0, 0, 0}), make_ray(o, d, kNan), make_ray(o, d, 0, kNan),
                        make_ray(o, d, 0.0F, -1.0F), make_ray(o, d, 2.0F, 1.0F),
                        make_ray(o, d * 1e-40F), make_ray(o, d * 1e35F)};
  for (int k = 0; k < 3; ++k) {
    for (const float bad : {kNan, kInf, -kInf}) {
      Ray ray = make_ray(o, d);
      ray.o[k] = bad;
      rays.push_back(ray);
      ray = make_ray(o, d);
      ray.d[k] = bad;
      rays.push_back(ray);
    }
  }
  for (const Ray& ray : rays) EXPECT_EQ(hit_of(unit_triangle(), ray).id, render::kNoHit);
}

// The filter may only reject what the exact test rejects, at any scale (also where float products
// overflow or vanish), for aimed and for random rays.
TEST(TriangleHits, FilterNeverRejectsAHit) {
  TestRandom random(5);
  std::size_t hits = 0;
  for (int i = 0; i < 200'000; ++i) {
    const float scale = std::ldexp(1.0F, static_cast<int>(random.below(160)) - 80);
    render::LeafBlock<8> block{};
    block.id.fill(render::kNoHit);
    block.id[3] = 0;
    std::array<Vec3f, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = scale * random.in_box(-1, 1);
      for (std::size_t k = 0; k < 3; ++k) block.v[c][k][3] = p[c][static_cast<int>(k)];
    }
    const Vec3f aim = i % 3 == 0 ? p[0] : (i % 3 == 1 ? 0.5F * (p[0] + p[1]) : point_on(random, p));
    Ray ray = ray_to(scale * random.in_box(-2, 2), aim);
    ray.d /= scale;
    render::ShearedRay sheared;
    if (!render::prepare(ray, sheared)) continue;
    Hit hit;
    if (!render::test_lane(sheared, block, 3, hit)) continue;
    ++hits;
    std::array<std::int32_t, 8> pass{};
    render::passes_filter<8>(sheared, block, pass);
    EXPECT_EQ(pass[3], 1);
  }
  EXPECT_GT(hits, 80'000U);
}

}  // namespace
}  // namespace raykiln::test
