// O(N log N), counted instead of timed: operations / (N lg N) may not grow with N, nor the memory for a
// reference. A builder that sorts in every cell is measured in the same way, to see that the limit can
// be missed.
// RAYKILN_LONG=1 measures every power of two from 2^12 to 2^20.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "resorting_builder.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

constexpr double kMostGrowth = 1.25;

double n_lg_n(const TestMesh& mesh) {
  const auto n = static_cast<double>(mesh.triangles.size());
  return n * std::log2(n);
}

struct Effort {
  double operations = 0.0;  ///< over N lg N
  double bytes = 0.0;       ///< most alive at once, over the references of the tree
  double references = 0.0;  ///< over N
};

Effort effort(const TestMesh& mesh) {
  const auto tree = build(mesh);
  const auto& s = render::build_stats(*tree);
  return {static_cast<double>(s.events_swept + s.events_moved + s.keys_sorted_passes) / n_lg_n(mesh),
          static_cast<double>(s.live_bytes_peak) / static_cast<double>(s.references),
          static_cast<double>(s.references) / static_cast<double>(s.triangles)};
}

bool is_long() {
  const char* set = std::getenv("RAYKILN_LONG");
  return set != nullptr && *set != '\0' && *set != '0';
}

void expect_bounded_growth(const char* name, const std::function<TestMesh(std::size_t)>& make,
                           int largest_lg = 18) {
  const Effort first = effort(make(std::size_t{1} << 12));
  std::printf("%-20s 2^12: %.2f, %.0f B", name, first.operations, first.bytes);
  if (is_long()) largest_lg = 20;
  for (int lg = is_long() ? 13 : 14; lg <= largest_lg; lg += is_long() ? 1 : 2) {
    const Effort now = effort(make(std::size_t{1} << lg));
    std::printf("  2^%d: %.2f, %.0f B", lg, now.operations, now.bytes);
    EXPECT_LE(now.operations, kMostGrowth * first.operations) << name << " 2^" << lg;
    EXPECT_LE(now.bytes, kMostGrowth * first.bytes) << name << " 2^" << lg;
    EXPECT_LE(now.references, render::BuildParams{}.max_duplication) << name << " 2^" << lg;
  }
  std::printf("\n");
}

TestMesh square_terrain(std::size_t n) {
  return terrain(static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 2.0))));
}

TestMesh square_grid(std::size_t n) {
  return coplanar_grid(
      static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 2.0))));
}
TestMesh round_ball(std::size_t n) {
  const auto nv = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 4)));
  return sphere(2 * nv, nv);
}
TestMesh giant_and_tiny(std::size_t n) {
  TestMesh mesh = soup(n - 1);
  for (Vec3f& p : mesh.positions) p = p * 0.001F + Vec3f(1000.0F, 1.0F, 0.0F);
  mesh.add({-1e6F, 0.0F, -1e6F}, {1e6F, 0.0F, -1e6F}, {0.0F, 0.0F, 1e6F});
  return mesh;
}

TestMesh grid_room(std::size_t n) {
  return box_room(
      static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(n) / 12.0))));
}

TestMesh many_hairs(std::size_t n) { return hair(static_cast<std::uint32_t>(n / 32), 16); }

TEST(BuildGrowth, Terrain) { expect_bounded_growth("terrain", square_terrain); }
TEST(BuildGrowth, Soup) {
  expect_bounded_growth("soup", [](std::size_t n) { return soup(n); });
}
TEST(BuildGrowth, IdenticalTriangles) {
  expect_bounded_growth("identical", identical_triangles);
}
TEST(BuildGrowth, CoplanarGrid) {
  expect_bounded_growth("coplanar grid", square_grid);
}
TEST(BuildGrowth, BoxRoom) { expect_bounded_growth("box room", grid_room); }
TEST(BuildGrowth, Sphere) {
  expect_bounded_growth("sphere", round_ball);
}
// The budget must hold this family, whose references would grow like N^1.5.
TEST(BuildGrowth, Slivers) {
  expect_bounded_growth("slivers", [](std::size_t n) { return slivers(n); }, 16);
}
TEST(BuildGrowth, Hair) { expect_bounded_growth("hair", many_hairs); }
TEST(BuildGrowth, OneGiantAndManyTiny) {
  expect_bounded_growth("giant and tiny", giant_and_tiny);
}

// The control: the same tree by sorting in every cell goes beyond the limit that the real one keeps.
TEST(BuildGrowth, SortingInEveryCellIsNoticed) {
  int noticed = 0;
  const std::array<std::pair<const char*, std::function<TestMesh(std::size_t)>>, 5> families{
      {{"terrain", square_terrain},
       {"soup", [](std::size_t n) { return soup(n); }},
       {"coplanar grid", square_grid},
       {"sphere", round_ball},
       {"box room", grid_room}}};
  for (const auto& [name, make] : families) {
    const TestMesh small = make(std::size_t{1} << 12), large = make(std::size_t{1} << 17);
    const auto tree = build(small);
    const Resorted first = ResortingBuilder(small).run();
    EXPECT_EQ(first.nodes, render::build_stats(*tree).nodes) << name;
    EXPECT_EQ(first.references, render::build_stats(*tree).references) << name;
    const Resorted last = ResortingBuilder(large).run();
    const double growth = static_cast<double>(last.operations) / n_lg_n(large) /
                          (static_cast<double>(first.operations) / n_lg_n(small));
    std::printf("%-20s 2^17 against 2^12: %.2f\n", name, growth);
    noticed += growth > kMostGrowth ? 1 : 0;
  }
  EXPECT_GE(noticed, 4);
}

}  // namespace
}  // namespace raykiln::test
