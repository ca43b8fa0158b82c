// V01, V02: rays along axes, with zero and minus zero, in split planes and in the planes of
// triangles.
#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"

namespace raykiln::hard {
namespace {

using render::next_down;
using render::next_up;
using test::build;

// A room with two boxes that has corners at x = 0, as the classic one.
TestMesh cornell_like() {
  TestMesh mesh = test::box_room(2, 1.0F);
  mesh.append(cube({-0.6F, -1.0F, -0.6F}, {0.0F, 0.2F, 0.0F}));
  mesh.append(cube({0.0F, -1.0F, -0.2F}, {0.5F, -0.4F, 0.4F}));
  return mesh;
}

std::vector<TestMesh> axis_meshes(TestRandom& random) {
  std::vector<TestMesh> meshes{cornell_like(), test::box_room(8), icosphere(2), test::terrain(12),
                               test::soup(300, 7, 2.0F)};
  TestMesh snapped = test::soup(300, 8, 3.0F);  // all corners on a grid of eighths
  for (Vec3f& p : snapped.positions) p = glm::round(p * 8.0F) / 8.0F;
  meshes.push_back(std::move(snapped));
  TestMesh turned = cornell_like();
  apply(random_similarity(random, 2.0), turned);
  meshes.push_back(std::move(turned));
  return meshes;
}

TEST(V01_AxisParallel, CentreColumnOfAnOddImage) {
  Row row("V01", "65 x 65 picture from x = 0 along -z (and every axis) into a room with corners at "
          "x = 0", "hits equal brute force; no ray is lost");
  const TestMesh mesh = cornell_like();
  const auto tree = build(mesh);
  Tally total;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0F, -1.0F}) {
      int pixel = 0;
      total += trace_and_compare(*tree, 65 * 65, 65 * 65, [&] {
        Ray ray;
        ray.o = Vec3f(0.0F);
        ray.o[axis] = -0.9F * sign;
        ray.d[(axis + 1) % 3] = static_cast<float>(pixel % 65 - 32) / 40.0F;
        ray.d[(axis + 2) % 3] = static_cast<float>(32 - pixel / 65) / 40.0F;
        ray.d[axis] = sign;
        ++pixel;
        return ray;
      });
    }
  }
  row.never("lost", total.rays - total.hits, total.rays);
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.hits, total.rays);
  EXPECT_EQ(total.mismatches, 0U);
}

// The 27 - 1 patterns of {+1, -1, 0} with both zeros wherever there is one.
Vec3f sign_pattern(std::uint64_t i, TestRandom& random) {
  Vec3f d(0.0F);
  for (int k = 0; k < 3; ++k, i /= 3) {
    const auto digit = i % 3;
    d[k] = digit == 0 ? 1.0F : (digit == 1 ? -1.0F : ((random.bits() & 1) != 0 ? 0.0F : -0.0F));
  }
  return d;
}

TEST(V01_AxisParallel, SignPatternsFromSplitPlanes) {
  Row row("V01", "26 sign patterns of {+0,-0,+1,-1}^3; origins on split coordinates of 7 trees, and "
          "1 ulp beside", "hits equal brute force; <= 4x the nodes of the ray tilted by 1e-3");
  TestRandom random(101);
  Tally total;
  double worst = 0.0;
  for (const TestMesh& mesh : axis_meshes(random)) {
    const auto tree = build(mesh);
    const auto box = render::bounds(*tree);
    std::vector<render::KdNode> inner;
    for (const auto node : tree->nodes) {
      if (!render::is_leaf(node)) inner.push_back(node);
    }
    ASSERT_FALSE(inner.empty());
    std::vector<Ray> rays, tilted;
    const std::uint64_t n = trials(150'000, 1'500'000);
    for (std::uint64_t i = 0; i < n; ++i) {
      Ray ray;
      for (int k = 0; k < 3; ++k) ray.o[k] = random.uniform(box.lo[k], box.hi[k]);
      // Splits on one, two or all axes at once.
      for (std::uint64_t times = 0; times <= i % 3; ++times) {
        const auto node = inner[random.below(static_cast<std::uint32_t>(inner.size()))];
        const float at = render::split_position(node);
        const std::array<float, 3> choice{at, next_up(at), next_down(at)};
        ray.o[static_cast<int>(render::split_axis(node))] = choice[random.below(3)];
      }
      ray.d = sign_pattern(i % 26, random);
      rays.push_back(ray);
      const Vec3f tilt = 1e-3F * random.direction();
      ray.d = ray.d + tilt;
      tilted.push_back(ray);
    }
    std::size_t next = 0;
    total += trace_and_compare(*tree, n, n, [&] { return rays[next++]; });
    std::vector<Hit> hits(rays.size());
    render::TraversalCounters straight, oblique;
    render::closest_hits(*tree, rays, hits, {}, render::Traversal::kTree, &straight);
    render::closest_hits(*tree, tilted, hits, {}, render::Traversal::kTree, &oblique);
    worst = std::max(worst, static_cast<double>(straight.node_steps + straight.leaf_visits) /
                                static_cast<double>(oblique.node_steps + oblique.leaf_visits));
  }
  row.never("differences", total.mismatches, total.compared);
  row.measured("nodes against tilted", worst);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_LE(worst, 4.0);
}

// ---- V02: rays in the plane of triangles ----

// A floor of random triangles in the plane axis = height around the middle, closed by walls that
// stand on its border: on the high side of axis + 1 and of axis + 2.
struct Floor {
  TestMesh mesh;
  std::uint32_t floor_triangles = 0;
};

Floor floor_with_walls(int axis, float height, float size, TestRandom& random) {
  Floor result;
  const auto at = [&](float u, float v, float w) {
    Vec3f p;
    p[axis] = w;
    p[(axis + 1) % 3] = u * size;
    p[(axis + 2) % 3] = v * size;
    return p;
  };
  const auto add_quad = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    result.mesh.add(a, b, c);
    result.mesh.add(a, c, d);
  };
  add_quad(at(-1, -1, height), at(1, -1, height), at(1, 1, height), at(-1, 1, height));
  for (int i = 0; i < 50; ++i) {
    result.mesh.add(at(random.uniform(-1, 1), random.uniform(-1, 1), height),
                    at(random.uniform(-1, 1), random.uniform(-1, 1), height),
                    at(random.uniform(-1, 1), random.uniform(-1, 1), height));
  }
  result.floor_triangles = static_cast<std::uint32_t>(result.mesh.triangles.size());
  const float top = height + size;
  add_quad(at(1, -1, height), at(1, 1, height), at(1, 1, top), at(1, -1, top));
  add_quad(at(-1, 1, height), at(1, 1, height), at(1, 1, top), at(-1, 1, top));
  return result;
}

TEST(V02_InThePlane, WallsBehindAreHit) {
  Row row("V02", "60 floors of 52 coplanar triangles on any axis, height and size; rays in their "
          "plane and 1 ulp off it, with walls on the border",
          "never a coplanar triangle, no NaN; in the plane the wall's lower edge is hit");
  TestRandom random(201);
  std::uint64_t coplanar = 0, nans = 0, lost = 0, rays_in_plane = 0, n = 0;
  Tally total;
  const std::uint64_t each = trials(102'000, 10'000'000) / 60;
  for (int member = 0; member < 60; ++member) {
    const int axis = member % 3;
    const float size = std::pow(10.0F, random.uniform(-3.0F, 3.0F));
    const float height = member % 5 == 0 ? 0.0F : size * random.uniform(-10.0F, 10.0F);
    const Floor floor = floor_with_walls(axis, height, size, random);
    const auto tree = build(floor.mesh);
    const std::array<float, 3> planes{height, next_up(height), next_down(height)};
    std::uint64_t i = 0;
    const auto make = [&] {
      Ray ray;
      ray.o = size * random.in_box(-1.0F, 1.0F);
      ray.o[axis] = planes[i++ % 3];
      ray.d = random.direction();
      ray.d[axis] = (random.bits() & 1) != 0 ? 0.0F : -0.0F;
      for (int k = 1; k <= 2; ++k) {
        ray.d[(axis + k) % 3] = std::abs(ray.d[(axis + k) % 3]) + 1e-3F;
        if (i % 7 == 0 && k == 1) ray.d[(axis + 1) % 3] = 0.0F;  // along an axis
      }
      return ray;
    };
    trace_batches(*tree, each, make, [&](const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
      std::vector<Hit> expected(rays.size());
      render::closest_hits(*tree, rays, expected, {}, render::Traversal::kBruteForce);
      for (std::size_t k = 0; k < hits.size(); ++k) {
        const Hit& hit = hits[k];
        const bool in_plane = rays[k].o[axis] == height;
        coplanar += hit.id < floor.floor_triangles ? 1U : 0U;
        nans += std::isnan(hit.t) || std::isnan(hit.u) || std::isnan(hit.v) ? 1U : 0U;
        rays_in_plane += in_plane ? 1U : 0U;
        lost += in_plane && hit.id == render::kNoHit ? 1U : 0U;
        total.mismatches += test::same_bits(hit, expected[k]) ? 0U : 1U;
      }
      n += hits.size();
    });
  }
  row.never("hits on coplanar triangles", coplanar, n);
  row.never("NaN", nans, n);
  row.never("walls missed", lost, rays_in_plane);
  row.never("differences", total.mismatches, n);
  EXPECT_EQ(coplanar, 0U);
  EXPECT_EQ(nans, 0U);
  EXPECT_EQ(lost, 0U);
  EXPECT_EQ(total.mismatches, 0U);
}

}  // namespace
}  // namespace raykiln::hard
