// O(N log N), counted instead of timed: operations / (N lg N) may not grow with N.
#include <cmath>
#include <cstdio>
#include <functional>

#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

double operations_per_n_lg_n(const TestMesh& mesh) {
  const auto tree = build(mesh);
  const auto& s = render::build_stats(*tree);
  const auto n = static_cast<double>(mesh.triangles.size());
  return static_cast<double>(s.events_swept + s.events_moved + s.keys_sorted_passes) /
         (n * std::log2(n));
}

void expect_bounded_growth(const char* name, const std::function<TestMesh(std::size_t)>& make,
                           int largest_lg = 18) {
  const double first = operations_per_n_lg_n(make(std::size_t{1} << 12));
  std::printf("%-20s 2^12: %.2f", name, first);
  for (int lg = 14; lg <= largest_lg; lg += 2) {
    const double now = operations_per_n_lg_n(make(std::size_t{1} << lg));
    std::printf("  2^%d: %.2f", lg, now);
    EXPECT_LE(now, 1.25 * first) << name << " 2^" << lg;
  }
  std::printf("\n");
}

TestMesh square_terrain(std::size_t n) {
  return terrain(static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 2.0))));
}

TEST(BuildGrowth, Terrain) { expect_bounded_growth("terrain", square_terrain); }
TEST(BuildGrowth, Soup) {
  expect_bounded_growth("soup", [](std::size_t n) { return soup(n); });
}
TEST(BuildGrowth, IdenticalTriangles) {
  expect_bounded_growth("identical", identical_triangles);
}
TEST(BuildGrowth, CoplanarGrid) {
  expect_bounded_growth("coplanar grid", [](std::size_t n) {
    return coplanar_grid(
        static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 2.0))));
  });
}
TEST(BuildGrowth, Sphere) {
  expect_bounded_growth("sphere", [](std::size_t n) {
    const auto nv = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 4)));
    return sphere(2 * nv, nv);
  });
}
// The budget must hold this family, whose references would grow like N^1.5.
TEST(BuildGrowth, Slivers) {
  expect_bounded_growth("slivers", [](std::size_t n) { return slivers(n); }, 16);
}
TEST(BuildGrowth, OneGiantAndManyTiny) {
  expect_bounded_growth("giant and tiny", [](std::size_t n) {
    TestMesh mesh = soup(n - 1);
    for (Vec3f& p : mesh.positions) p = p * 0.001F + Vec3f(1000.0F, 1.0F, 0.0F);
    mesh.add({-1e6F, 0.0F, -1e6F}, {1e6F, 0.0F, -1e6F}, {0.0F, 0.0F, 1e6F});
    return mesh;
  });
}

}  // namespace
}  // namespace raykiln::test
