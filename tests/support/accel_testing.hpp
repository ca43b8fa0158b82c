// What several tests of the kd-tree share: rays of every kind, bit equality of hits.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <vector>

#include "raykiln/accel/kdtree_data.hpp"
#include "raykiln/accel/kernels.hpp"
#include "raykiln/math/float_bits.hpp"
#include "support/mesh_generators.hpp"
#include "support/thread_runner.hpp"

namespace raykiln::test {

inline std::shared_ptr<const render::KdTree> build(const TestMesh& mesh,
                                                   const render::BuildParams& params = {}) {
  render::SerialTaskRunner runner;
  return render::build_kdtree(mesh.view(), params, runner);
}

inline render::Ray ray_to(const Vec3f& origin, const Vec3f& target) {
  render::Ray ray;
  ray.o = origin;
  ray.d = target - origin;
  return ray;
}

inline Vec3f point_on(TestRandom& random, const std::array<Vec3f, 3>& p) {
  const float a = random.uniform();
  const float b = random.uniform() * (1.0F - a);
  return p[0] * (1.0F - a - b) + p[1] * a + p[2] * b;
}

/// Rays that have broken walks before: through space, at triangles, at their edges and corners, along
/// axes and in planes, from surfaces, from split planes, from far away, with short intervals.
inline std::vector<render::Ray> hard_rays(const render::KdTree& tree, const TestMesh& mesh,
                                          std::size_t n, std::uint64_t seed) {
  TestRandom random(seed);
  const render::Bounds3f box = render::bounds(tree);
  const Vec3f size = box.hi - box.lo;
  const float reach = std::max({size.x, size.y, size.z});
  const auto any_corner = [&] {
    const auto& t = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
    return mesh.positions[t[random.below(3)]];
  };
  const auto near_box = [&] { return box.lo + size * 0.5F + reach * random.in_box(-1.0F, 1.0F); };
  const auto inside = [&] { return box.lo + size * random.in_box(0.0F, 1.0F); };
  std::vector<render::Ray> rays;
  rays.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto corners =
        mesh.corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
    const Vec3f edge_point = corners[0] + (corners[1] - corners[0]) * random.uniform();
    render::Ray ray;
    switch (i % 12) {
      case 0: ray = ray_to(near_box(), inside()); break;
      case 1: ray = ray_to(near_box(), point_on(random, corners)); break;
      case 2: ray = ray_to(inside(), edge_point); break;
      case 3: ray = ray_to(near_box(), any_corner()); break;
      case 4: ray = ray_to(any_corner(), any_corner()); break;
      case 5: {  // along an axis, in the plane of some vertex
        const auto axis = static_cast<int>(random.below(3));
        ray.o = any_corner();
        ray.o[axis] = near_box()[axis];
        ray.d = Vec3f((random.bits() & 1) != 0 ? 0.0F : -0.0F);
        ray.d[axis] = (random.bits() & 1) != 0 ? 1.0F : -1.0F;
        break;
      }
      case 6:  // one component of the direction is zero
        ray = ray_to(near_box(), any_corner());
        ray.d[static_cast<int>(random.below(3))] = (random.bits() & 1) != 0 ? 0.0F : -0.0F;
        break;
      case 7: {  // origin in a split plane, or one ulp beside
        ray = ray_to(inside(), inside());
        const render::KdNode node =
            tree.nodes[random.below(static_cast<std::uint32_t>(tree.nodes.size()))];
        if (render::is_leaf(node)) break;
        const auto axis = static_cast<int>(render::split_axis(node));
        const float split = render::split_position(node);
        const std::array<float, 3> at{split, render::next_up(split), render::next_down(split)};
        ray.o[axis] = at[random.below(3)];
        if ((random.bits() & 1) != 0) ray.d[axis] = 0.0F;
        break;
      }
      case 8:  // from a surface
        ray = ray_to(point_on(random, corners), inside());
        break;
      case 9: {  // from a face, an edge or a corner of the root's box
        Vec3f at = inside();
        for (int k = 0; k < 3; ++k) {
          const auto where = random.below(3);
          if (where < 2) at[k] = where == 0 ? box.lo[k] : box.hi[k];
        }
        ray = ray_to(at, inside());
        break;
      }
      case 10:  // from far away
        ray = ray_to(inside() + 1000.0F * reach * random.direction(), edge_point);
        break;
      default: {  // a short interval that begins or ends at the point aimed at
        ray = ray_to(near_box(), edge_point);
        ray.t_min = (random.bits() & 1) != 0 ? 1.0F : 0.0F;
        ray.t_max = ray.t_min + 1.0F;
        break;
      }
    }
    if (ray.d == Vec3f(0.0F)) ray.d = random.direction();
    rays.push_back(ray);
  }
  return rays;
}

inline constexpr std::array kTriangleTests{render::TriangleTest::kWatertight,
                                           render::TriangleTest::kFast};

/// Every walk that this processor can run, with a test.
inline std::vector<render::Traversal> walks(
    render::TriangleTest test = render::TriangleTest::kWatertight) {
  std::vector<render::Traversal> result;
  for (const auto kernel :
       {render::Traversal::kScalar, render::Traversal::kAvx2, render::Traversal::kAvx512}) {
    if (render::is_available(kernel)) result.push_back(render::with_test(kernel, test));
  }
  return result;
}

inline render::Traversal brute_force(render::TriangleTest test) {
  return render::with_test(render::Traversal::kBruteForce, test);
}

inline bool same_bits(const render::Hit& a, const render::Hit& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

inline std::vector<render::Hit> closest(const render::KdTree& tree,
                                        const std::vector<render::Ray>& rays,
                                        render::Traversal traversal = render::Traversal::kTree) {
  std::vector<render::Hit> hits(rays.size());
  render::closest_hits(tree, rays, hits, {}, traversal);
  return hits;
}

/// How many hits differ in any bit; the first three are printed.
inline std::size_t count_differences(const std::vector<render::Ray>& rays,
                                     const std::vector<render::Hit>& a,
                                     const std::vector<render::Hit>& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (same_bits(a[i], b[i])) continue;
    if (++different > 3) continue;
    const render::Ray& r = rays[i];
    ADD_FAILURE() << "ray " << i << " (kind " << i % 12 << ") o " << r.o.x << ' ' << r.o.y << ' '
                  << r.o.z << " d " << r.d.x << ' ' << r.d.y << ' ' << r.d.z << ": t " << a[i].t
                  << " id " << a[i].id << " against t " << b[i].t << " id " << b[i].id;
  }
  return different;
}

inline std::size_t count_hits(const std::vector<render::Hit>& hits) {
  return static_cast<std::size_t>(std::count_if(
      hits.begin(), hits.end(), [](const render::Hit& h) { return h.id != render::kNoHit; }));
}

}  // namespace raykiln::test
