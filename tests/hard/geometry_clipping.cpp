// K03 (slivers), K12: what is kept and what is cut, against exact rational arithmetic.
#include <set>

#include "hard/support/exact_clip.hpp"
#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"
#include "polygon_clip.hpp"

namespace raykiln::hard {
namespace {

using render::Bounds3f;
using test::build;

// ---- K03: slivers that are on a line up to rounding ----

std::array<Vec3f, 3> rounded_sliver(TestRandom& random) {
  const float size = std::pow(10.0F, random.uniform(-6.0F, 6.0F));
  const Vec3f p0 = size * random.in_box(-1.0F, 1.0F);
  const Vec3f p1 = size * random.in_box(-1.0F, 1.0F);
  return {p0, p1, p0 + random.uniform(-0.5F, 1.5F) * (p1 - p0)};
}

TEST(K03_DegenerateTriangles, SliversKeepTheirExactArea) {
  Row row("K03", "1e4 slivers on a line up to rounding, size 10^U(-6,6), one in ten exactly on a line",
          "dropped exactly when the exact area is 0");
  TestRandom random(301);
  std::uint64_t wrong = 0, kept = 0, dropped = 0;
  for (int i = 0; i < 10'000; ++i) {
    auto p = rounded_sliver(random);
    if (i % 10 == 0) {  // integers on a line
      const Vec3f step = glm::round(random.in_box(-50.0F, 50.0F));
      p[0] = glm::round(random.in_box(-1000.0F, 1000.0F));
      p[1] = p[0] + step * static_cast<float>(random.below(100));
      p[2] = p[0] - step * static_cast<float>(random.below(100));
    }
    const bool zero = !has_area(exact_triangle(p));
    const bool found = render::has_zero_area(p[0], p[1], p[2]);
    wrong += zero != found ? 1U : 0U;
    (found ? dropped : kept) += 1;
  }
  row.never("wrong decisions", wrong, kept + dropped);
  row.measured("kept", kept);
  row.measured("dropped", dropped);
  EXPECT_EQ(wrong, 0U);
  EXPECT_GE(dropped, 1000U);
  EXPECT_GE(kept, 5000U);
}

TEST(K03_DegenerateTriangles, SliversHitLikeBruteForce) {
  Row row("K03", "10k terrain with 1000 slivers across it, 20 of 200 with 30; rays at the slivers",
          "no NaN; hits equal brute force");
  TestRandom random(302);
  std::uint64_t nans = 0, traced = 0;
  Tally total;
  for (int member = 0; member <= 20; ++member) {
    const bool large = member == 0;
    TestMesh mesh = test::terrain(large ? 71 : 10, 1 + static_cast<std::uint64_t>(member));
    TestMesh slivers;
    const std::uint32_t count = large ? 1000 : 30;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3f p0 = random.in_box(0.0F, 1.0F);
      const Vec3f p1 = random.in_box(0.0F, 1.0F);
      slivers.add(p0, p1, p0 + 0.3F * (p1 - p0));
    }
    mesh.append(slivers);
    mesh = test::shuffled(mesh, 303);
    const auto tree = build(mesh);
    const auto make = [&] {
      return test::ray_to(random.in_box(-1.0F, 2.0F),
                          test::point_on(random, slivers.corners(random.below(count))));
    };
    const std::uint64_t n = large ? trials(20'000, 200'000) : trials(50'000, 500'000);
    total += trace_and_compare(*tree, n, n, make);
    trace_batches(*tree, n, make, [&](const auto&, const auto& hits) {
      for (const Hit& hit : hits) nans += std::isnan(hit.t + hit.u + hit.v) ? 1U : 0U;
      traced += hits.size();
    });
  }
  row.never("NaN", nans, traced);
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(nans, 0U);
  EXPECT_EQ(total.mismatches, 0U);
}

// ---- K12: clipped fragments are conservative ----

std::array<Vec3f, 3> triangle_of_kind(TestRandom& random, int kind) {
  std::array<Vec3f, 3> p{random.in_box(0.0F, 1.0F), random.in_box(0.0F, 1.0F),
                         random.in_box(0.0F, 1.0F)};
  if (kind == 1) p[2] = p[0] + 0.4F * (p[1] - p[0]) + 1e-4F * random.direction();
  if (kind == 2) {
    for (Vec3f& q : p) q = glm::round(q * 8.0F) / 8.0F;
  }
  if (kind == 3) {
    for (Vec3f& q : p) q = p[0] + 0.1F * (q - p[0]);
  }
  return p;
}

TEST(K12_ConservativeClipping, FragmentBoxes) {
  Row row("K12", "random, thin, grid-snapped and small triangles against random voxels, exact clipping "
          "in rationals", "clipped in double, rounded outwards: the box holds the exact fragment up to "
          "the rounding of double; never empty wrongly");
  TestRandom random(1201);
  std::uint64_t too_small = 0, not_exact = 0, lost = 0, fragments = 0;
  double worst = 0.0;
  const std::uint64_t n = trials(60'000, 1'000'000);
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto corners = triangle_of_kind(random, static_cast<int>(i % 4));
    Bounds3f voxel;
    voxel.grow(random.in_box(0.0F, 1.0F));
    voxel.grow(random.in_box(0.0F, 1.0F));
    if (i % 8 == 2) {
      voxel.lo = glm::floor(voxel.lo * 8.0F) / 8.0F;
      voxel.hi = glm::ceil(voxel.hi * 8.0F) / 8.0F;
    }
    const ExactPolygon exact = exact_clip(corners, voxel);
    if (!has_area(exact)) continue;  // a part that is a point or a segment may come and go
    ++fragments;
    const auto box = render::clipped_bounds(corners, voxel);
    lost += !box ? 1U : 0U;
    const double out = box ? excess(*box, exact) : 0.0;
    too_small += out > 0x1p-50 ? 1U : 0U;
    not_exact += out > 0.0 ? 1U : 0U;
    worst = std::max(worst, out);
  }
  row.never("boxes too small", too_small, fragments);
  row.never("by less than 2^-50", not_exact - too_small, fragments);
  row.measured("largest excess", worst);
  row.never("fragments lost", lost, fragments);
  EXPECT_EQ(too_small, 0U);
  EXPECT_EQ(lost, 0U);
  EXPECT_GT(fragments, n / 10);
}

// Boxes that overlap by more than the error of clipping in double, decided in double: true only when
// the part of the triangle in the box enlarged by 1e-6 is not empty. Rules out, never in.
bool may_meet(const std::array<Vec3f, 3>& corners, const Bounds3f& cell) {
  Bounds3f enlarged = cell;
  enlarged.lo -= Vec3f(1e-6F);
  enlarged.hi += Vec3f(1e-6F);
  return render::clipped_bounds(corners, enlarged).has_value();
}

struct LeafCheck {
  std::uint64_t leaves = 0, pairs = 0, decided_exactly = 0, violations = 0;
  std::uint64_t planar_points = 0, planar_lost = 0;
};

// A triangle in a split plane meets the closed cells on both sides of it with an area, and the builder
// lists it on one: a hit is judged against the interval of the ray, and at equal t a walk goes on, so
// one suffices. What such a triangle needs is that around each of its points one cell lists it.
bool lies_in_a_face(const std::array<Vec3f, 3>& p, const Bounds3f& cell) {
  for (int k = 0; k < 3; ++k) {
    const bool planar = p[0][k] == p[1][k] && p[1][k] == p[2][k];
    if (planar && (p[0][k] == cell.lo[k] || p[0][k] == cell.hi[k])) return true;
  }
  return false;
}

void check_leaf(const KdTree& tree, const TestMesh& mesh, render::KdNode leaf, const Bounds3f& cell,
                LeafCheck& check) {
  std::set<std::uint32_t> listed;
  for (std::uint32_t b = 0; b < render::block_count(leaf); ++b) {
    const auto& ids = tree.blocks8[render::first_block(leaf) + b].id;
    listed.insert(ids.begin(), ids.end());
  }
  ++check.leaves;
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    ++check.pairs;
    const auto corners = mesh.corners(id);
    if (listed.contains(id) || !may_meet(corners, cell) || lies_in_a_face(corners, cell)) continue;
    ++check.decided_exactly;
    check.violations += has_area(exact_clip(corners, cell)) ? 1U : 0U;
  }
}

void check_node(const KdTree& tree, const TestMesh& mesh, std::uint32_t index, const Bounds3f& cell,
                LeafCheck& check) {
  const render::KdNode node = tree.nodes[index];
  if (render::is_leaf(node)) return check_leaf(tree, mesh, node, cell, check);
  const auto axis = static_cast<int>(render::split_axis(node));
  Bounds3f left = cell;
  Bounds3f right = cell;
  left.hi[axis] = right.lo[axis] = render::split_position(node);
  check_node(tree, mesh, render::left_child(node), left, check);
  check_node(tree, mesh, render::left_child(node) + 1, right, check);
}

// Whether a leaf whose closed cell holds p lists the triangle.
bool listed_at(const KdTree& tree, std::uint32_t index, const Vec3f& p, std::uint32_t id) {
  const render::KdNode node = tree.nodes[index];
  if (render::is_leaf(node)) {
    for (std::uint32_t b = 0; b < render::block_count(node); ++b) {
      const auto& ids = tree.blocks8[render::first_block(node) + b].id;
      if (std::find(ids.begin(), ids.end(), id) != ids.end()) return true;
    }
    return false;
  }
  const float at = p[static_cast<int>(render::split_axis(node))];
  const float split = render::split_position(node);
  const std::uint32_t left = render::left_child(node);
  return (at <= split && listed_at(tree, left, p, id)) ||
         (at >= split && listed_at(tree, left + 1, p, id));
}

void check_planar(const KdTree& tree, const TestMesh& mesh, TestRandom& random, LeafCheck& check) {
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    const auto c = mesh.corners(id);
    for (int k = 0; k < 3; ++k) {
      if (c[0][k] != c[1][k] || c[1][k] != c[2][k]) continue;
      for (int i = 0; i < 20; ++i) {
        Vec3f p = 0.999F * test::point_on(random, c) + 0.001F * (c[0] + c[1] + c[2]) / 3.0F;
        p[k] = c[0][k];
        ++check.planar_points;
        check.planar_lost += listed_at(tree, 0, p, id) ? 0U : 1U;
      }
    }
  }
}

TEST(K12_ConservativeClipping, EveryLeafListsItsTriangles) {
  Row row("K12", "112 scenes of 200 triangles: random, thin, grid-snapped, small, axis-parallel; every leaf",
          "a triangle whose exact part in the closed voxel has an area is listed; in a split plane: on one side");
  TestRandom random(1202);
  LeafCheck check;
  const auto scenes = static_cast<int>(trials(112, 1120));
  for (int scene = 0; scene < scenes; ++scene) {
    TestMesh mesh;
    while (mesh.triangles.size() < 200) {
      auto p = triangle_of_kind(random, scene % 5);
      if (scene % 5 == 4) {
        const auto axis = static_cast<int>(random.below(3));
        const float at = static_cast<float>(random.below(9)) / 8.0F;
        for (Vec3f& q : p) q[axis] = at;
      }
      if (!render::has_zero_area(p[0], p[1], p[2])) mesh.add(p[0], p[1], p[2]);
    }
    render::BuildParams params;
    params.max_duplication = 20.0;
    const auto tree = build(mesh, params);
    check_node(*tree, mesh, 0, render::bounds(*tree), check);
    check_planar(*tree, mesh, random, check);
  }
  row.never("violations", check.violations, check.pairs);
  row.measured("leaves", check.leaves);
  row.measured("pairs decided in rationals", check.decided_exactly);
  row.never("points in planes that no side lists", check.planar_lost, check.planar_points);
  EXPECT_EQ(check.violations, 0U);
  EXPECT_EQ(check.planar_lost, 0U);
  EXPECT_GT(check.planar_points, 10'000U);
  EXPECT_GT(check.leaves, 4000U);
}

}  // namespace
}  // namespace raykiln::hard
