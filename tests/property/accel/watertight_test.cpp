// A closed mesh lets no ray out: V03, V04, V05 (edges, vertices, far from the origin).
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::Ray;

enum class Aim { kEdge, kVertex, kRandom };

// Rays from points near `centre`, well inside, at random points of random edges or at vertices.
std::size_t count_leaks(const TestMesh& mesh, const Vec3f& centre, float spread, Aim aim, std::size_t n,
                        render::Traversal walk = render::Traversal::kTree) {
  const auto tree = build(mesh);
  TestRandom random(21);
  std::vector<Ray> rays(4096);
  std::size_t leaks = 0;
  for (std::size_t done = 0; done < n; done += rays.size()) {
    for (Ray& ray : rays) {
      const auto corners =
          mesh.corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
      const std::size_t first = random.below(3);
      const Vec3f along = corners[(first + 1) % 3] - corners[first];
      const Vec3f origin = centre + random.in_box(-spread, spread);
      const float s = aim == Aim::kEdge ? random.uniform() : 0.0F;
      ray.o = origin;
      ray.d = aim == Aim::kRandom ? random.direction()
                                  : render::normalize(corners[first] + along * s - origin);
    }
    leaks += rays.size() - count_hits(closest(*tree, rays, walk));
  }
  return leaks;
}

constexpr std::size_t kMillion = 1'000'000;

TEST(Watertight, SphereAimedAtEdges) {
  EXPECT_EQ(count_leaks(sphere(100, 50), Vec3f(0.0F), 0.5F, Aim::kEdge, kMillion), 0U);
}
TEST(Watertight, SphereAimedAtVertices) {
  EXPECT_EQ(count_leaks(sphere(100, 50), Vec3f(0.0F), 0.5F, Aim::kVertex, kMillion), 0U);
}
TEST(Watertight, RoomAimedAtEdgesAndVertices) {
  EXPECT_EQ(count_leaks(box_room(10), Vec3f(0.0F), 0.9F, Aim::kEdge, kMillion / 2), 0U);
  EXPECT_EQ(count_leaks(box_room(10), Vec3f(0.0F), 0.9F, Aim::kVertex, kMillion / 2), 0U);
}
TEST(Watertight, SphereFarFromTheOrigin) {
  const Vec3f centre(148376.0F, 1234.0F, -223423.0F);
  const TestMesh mesh = sphere(400, 200, centre, 2.0F);
  EXPECT_EQ(count_leaks(mesh, centre, 0.5F, Aim::kRandom, kMillion / 2), 0U);
}
TEST(Watertight, TinySphere) {
  const float radius = 0x1p-40F;
  const TestMesh mesh = sphere(40, 20, Vec3f(0.0F), radius);
  EXPECT_EQ(count_leaks(mesh, Vec3f(0.0F), 0.5F * radius, Aim::kEdge, kMillion / 4), 0U);
}

// The fast test takes a zero edge function for inside, so it leaks neither at edges nor at vertices as
// long as triangles have an area in float...
TEST(Watertight, FastTestAimedAtEdgesAndVertices) {
  constexpr auto kFast = render::Traversal::kFastTree;
  constexpr std::size_t kRays = kMillion / 10;
  const Vec3f centre(148376.0F, 1234.0F, -223423.0F);
  const float tiny = 0x1p-40F;
  for (const Aim aim : {Aim::kEdge, Aim::kVertex}) {
    EXPECT_EQ(count_leaks(sphere(100, 50), Vec3f(0.0F), 0.5F, aim, kRays, kFast), 0U);
    EXPECT_EQ(count_leaks(box_room(10), Vec3f(0.0F), 0.9F, aim, kRays, kFast), 0U);
    EXPECT_EQ(count_leaks(sphere(100, 50, centre, 2.0F), centre, 0.5F, aim, kRays, kFast), 0U);
    EXPECT_EQ(count_leaks(sphere(40, 20, Vec3f(0.0F), tiny), Vec3f(0.0F), 0.5F * tiny, aim, kRays, kFast), 0U);
  }
}
// ...and leaks everywhere when they have none: products of corners at 2^-75 vanish in float.
TEST(Watertight, FastTestLeaksWhereProductsOfFloatsVanish) {
  constexpr float kRadius = 0x1p-75F;
  const TestMesh mesh = sphere(40, 20, Vec3f(0.0F), kRadius);
  const auto tree = build(mesh);
  TestRandom random(31);
  std::vector<Ray> rays;
  for (int i = 0; i < 20'000; ++i) {
    const auto corners = mesh.corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
    rays.push_back(ray_to(random.in_box(-0.5F, 0.5F) * kRadius, corners[0]));
  }
  EXPECT_EQ(count_hits(closest(*tree, rays)), rays.size());
  EXPECT_EQ(count_hits(closest(*tree, rays, render::Traversal::kFastTree)), 0U);
}

}  // namespace
}  // namespace raykiln::test
