// Triangles on which rays begin and end: no walk meets them, and all walks still agree.
#include "same_counts.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::EndTriangles;
using render::Hit;
using render::Occlusion;
using render::Ray;
using render::Traversal;
using render::TraversalCounters;

struct Ends {
  std::vector<std::uint32_t> from, to;
  [[nodiscard]] EndTriangles view() const { return {from, to}; }
};

/// For most rays the triangles that they meet first and next, else any one, or none.
Ends ends_of(const render::KdTree& tree, const std::vector<Ray>& rays, render::TriangleTest test, std::uint64_t seed) {
  TestRandom random(seed);
  const auto first = closest(tree, rays, brute_force(test));
  std::vector<render::HitOrder> after;
  for (const Hit& hit : first) after.push_back(hit.id == render::kNoHit ? render::HitOrder{} : render::HitOrder{hit.t, hit.id});
  std::vector<Hit> second(rays.size());
  render::closest_hits(tree, rays, second, after, brute_force(test));
  Ends ends;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto any = static_cast<std::uint32_t>(random.below(100));
    ends.from.push_back(i % 4 == 0 ? any : first[i].id);
    ends.to.push_back(i % 8 == 1 ? render::kNoHit : second[i].id);
    if (i % 16 == 2) std::swap(ends.from[i], ends.to[i]);
  }
  return ends;
}

void expect_left_out(const render::KdTree& tree, const std::vector<Ray>& rays, render::TriangleTest test, const Ends& ends) {
  std::vector<Hit> expected(rays.size()), hits(rays.size());
  std::vector<Occlusion> blocked(rays.size()), result(rays.size());
  render::closest_hits(tree, rays, expected, {}, brute_force(test), nullptr, ends.view());
  render::any_hits(tree, rays, blocked, brute_force(test), nullptr, ends.view());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_FALSE(expected[i].id != render::kNoHit && ends.view().hold(i, expected[i].id));
    EXPECT_EQ(blocked[i] == Occlusion::kNone, expected[i].id == render::kNoHit);
  }
  TraversalCounters scalar_closest, scalar_any;
  const Traversal scalar = render::with_test(Traversal::kScalar, test);
  render::closest_hits(tree, rays, hits, {}, scalar, &scalar_closest, ends.view());
  render::any_hits(tree, rays, result, scalar, &scalar_any, ends.view());
  for (const Traversal walk : walks(test)) {
    SCOPED_TRACE(render::name(walk));
    TraversalCounters closest_counts, any_counts;
    render::closest_hits(tree, rays, hits, {}, walk, &closest_counts, ends.view());
    render::any_hits(tree, rays, result, walk, &any_counts, ends.view());
    EXPECT_EQ(count_differences(rays, hits, expected), 0U);
    EXPECT_EQ(result, blocked);
    expect_same_counts(closest_counts, scalar_closest);
    expect_same_counts(any_counts, scalar_any);
  }
}

TEST(EndTriangles, AreMetByNoWalk) {
  const std::vector<TestMesh> meshes{soup(2500, 1, 2.0F), terrain(40), soup(300, 2, 2.0F), slivers(150), coplanar_grid(6)};
  for (const TestMesh& mesh : meshes) {
    for (const int width : {8, 16}) {
      render::BuildParams params;
      params.leaf_width = width;
      const auto tree = build(mesh, params);
      const auto rays = hard_rays(*tree, mesh, 700, 41);
      for (const render::TriangleTest test : kTriangleTests) expect_left_out(*tree, rays, test, ends_of(*tree, rays, test, 5));
    }
  }
}

TEST(EndTriangles, OneListAloneAndNone) {
  const TestMesh mesh = soup(600, 3, 2.0F);
  const auto tree = build(mesh);
  const auto rays = hard_rays(*tree, mesh, 300, 42);
  const auto test = render::TriangleTest::kWatertight;
  Ends ends = ends_of(*tree, rays, test, 6);
  expect_left_out(*tree, rays, test, {ends.from, {}});
  expect_left_out(*tree, rays, test, {{}, ends.to});
  const auto expected = closest(*tree, rays, brute_force(test));
  std::vector<Hit> hits(rays.size());
  const std::vector<std::uint32_t> none(rays.size(), render::kNoHit);
  render::closest_hits(*tree, rays, hits, {}, Traversal::kTree, nullptr, {none, none});
  EXPECT_EQ(count_differences(rays, hits, expected), 0U);
}

}  // namespace
}  // namespace raykiln::test
