// V06, V07, V14 (rays): where rays that leave a surface start, and where shadow rays end.
#include <numbers>

#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"
#include "raykiln/math/frame.hpp"
#include "raykiln/shading/surface_point.hpp"
#include "shadow_queue.hpp"

namespace raykiln::hard {
namespace {

using render::ray_end;
using render::ray_origin;
using render::surface_point;
using render::SurfacePoint;
using test::build;

render::TriangleMesh scene_mesh(const TestMesh& mesh) {
  render::TriangleMesh result;
  result.positions = mesh.positions;
  result.triangles = mesh.triangles;
  result.material_ids.assign(mesh.triangles.size(), 0);
  return result;
}

struct Barycentrics {
  double u, v;
};
Barycentrics random_barycentrics(TestRandom& random) {
  double u = static_cast<double>(random.uniform());
  double v = static_cast<double>(random.uniform());
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {u, v};
}

// ---- V06: self-intersection and lost neighbours ----

std::array<Vec3f, 3> wild_triangle(TestRandom& random) {
  std::array<Vec3f, 3> p;
  for (Vec3f& q : p) {
    for (int k = 0; k < 3; ++k) {
      const float size = std::pow(10.0F, random.uniform(-8.0F, 8.0F));
      q[k] = (random.bits() & 1) != 0 ? size : -size;
    }
  }
  return p;
}

std::array<Vec3f, 3> unit_triangle_at(TestRandom& random, float distance) {
  const Vec3f centre = distance * random.direction();
  return {centre + random.in_box(-0.5F, 0.5F), centre + random.in_box(-0.5F, 0.5F),
          centre + random.in_box(-0.5F, 0.5F)};
}

struct SpawnCount {
  std::uint64_t rays = 0, self_hits = 0, bound_violations = 0;
};

// Distance of the point from the plane of the triangle, in long double.
long double off_plane(const std::array<Vec3f, 3>& p, const Vec3d& point) {
  using Vec3l = glm::vec<3, long double, glm::defaultp>;
  const Vec3l a(p[0]), b(p[1]), c(p[2]);
  const Vec3l n = glm::cross(b - a, c - a);
  return std::abs(glm::dot(n, Vec3l(point) - a)) / std::sqrt(glm::dot(n, n));
}

void spawn_from(const std::array<Vec3f, 3>& corners, std::uint64_t n, TestRandom& random,
                SpawnCount& count) {
  TestMesh mesh;
  mesh.add(corners[0], corners[1], corners[2]);
  const auto tree = build(mesh);
  if (tree->box.empty()) return;
  const render::TriangleMesh shading = scene_mesh(mesh);
  std::vector<Ray> rays;
  for (std::uint64_t i = 0; i < n; ++i) {
    Barycentrics b = random_barycentrics(random);
    if (i % 2 == 0) {  // a hit of the product instead of a point made up
      const Vec3f target = test::point_on(random, corners);
      const float reach = render::length(corners[1] - corners[0]) + render::length(target);
      Ray ray = test::ray_to(target + reach * random.direction(), target);
      Hit hit;
      render::closest_hits(*tree, std::span(&ray, 1), std::span(&hit, 1));
      if (hit.id != render::kNoHit) b = {static_cast<double>(hit.u), static_cast<double>(hit.v)};
    }
    const SurfacePoint point = surface_point(shading, 0, b.u, b.v);
    const auto vertex = [&](std::size_t c, double w) { return abs(w * Vec3d(corners[c])); };
    const Vec3d bound = render::gamma_bound(7) *
                        (vertex(0, 1.0 - b.u - b.v) + vertex(1, b.u) + vertex(2, b.v));
    count.bound_violations +=
        off_plane(corners, point.p) >
                static_cast<long double>(render::dot(abs(point.ng), bound)) ? 1U : 0U;
    Ray ray;
    ray.d = random.direction();
    ray.o = ray_origin(point, Vec3d(ray.d));
    rays.push_back(ray);
  }
  std::vector<Hit> hits(rays.size());
  render::closest_hits(*tree, rays, hits);
  count.rays += rays.size();
  const std::size_t self_hits = test::count_hits(hits);
  if (self_hits > 0 && count.self_hits < 3) {
    ADD_FAILURE() << std::hexfloat << self_hits << " self-hits: " << corners[0].x << ' '
                  << corners[0].y << ' ' << corners[0].z << ", " << corners[1].x << ' '
                  << corners[1].y << ' ' << corners[1].z << ", " << corners[2].x << ' '
                  << corners[2].y << ' ' << corners[2].z;
  }
  count.self_hits += self_hits;
}

TEST(V06_SelfIntersection, RandomTriangles) {
  Row row("V06", "1e3 triangles with coordinates 10^U(-8,8), 1e3 of size 1 at |p| = 1, 1e3, 1e6; "
          "rays spawned from random points and from hits",
          "no self-hit; the bound gamma_7 sum |b_i p_i| holds");
  TestRandom random(601);
  SpawnCount count;
  const std::uint64_t each = trials(500, 5000);
  for (int i = 0; i < 1000; ++i) {
    spawn_from(wild_triangle(random), each, random, count);
    const float distance = std::array<float, 3>{1.0F, 1e3F, 1e6F}[static_cast<std::size_t>(i) % 3];
    spawn_from(unit_triangle_at(random, distance), each, random, count);
  }
  row.never("self-hits", count.self_hits, count.rays);
  row.never("bound violated", count.bound_violations, count.rays);
  EXPECT_EQ(count.self_hits, 0U);
  EXPECT_EQ(count.bound_violations, 0U);
}

TEST(V06_SelfIntersection, SecondSheetIsHit) {
  Row row("V06", "two parallel sheets at gap 4 gamma_7 max|p|, 200 members: |p| = 1 to 1e6, any "
          "tilt; rays from the first towards the second", "the second sheet is hit by every ray");
  TestRandom random(602);
  std::uint64_t lost = 0, self = 0, n = 0;
  for (int member = 0; member < 200; ++member) {
    const double distance = std::pow(10.0, static_cast<double>(random.uniform(0.0F, 6.0F)));
    Similarity place = member % 4 == 0 ? Similarity{} : random_rotation(random);
    place.scale = 0.5 * distance;
    place.shift = 0.4 * distance * Vec3d(random.direction());
    TestMesh mesh = test::coplanar_grid(1);
    apply(place, mesh);
    float largest = 0.0F;
    for (const Vec3f& p : mesh.positions) {
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    const Vec3d normal = place.columns[2];
    const double gap = 4.0 * render::gamma_bound(7) * static_cast<double>(largest);
    TestMesh second = mesh;
    for (Vec3f& p : second.positions) p = Vec3f(Vec3d(p) + gap * normal);
    mesh.append(second);
    const auto tree = build(mesh);
    const auto shading = scene_mesh(mesh);
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < trials(5000, 50'000); ++i) {
      // In the middle of the sheet and not grazing: a ray that leaves must meet the second one.
      const SurfacePoint point =
          surface_point(shading, static_cast<std::uint32_t>(i % 2), 0.3 + 0.2 * static_cast<double>(random.uniform()),
                        0.3 + 0.1 * static_cast<double>(random.uniform()));
      Vec3f d = random.direction();
      const double up = render::dot(Vec3d(d), normal);
      if (up < 0.0) d = -d;
      if (std::abs(up) < 0.01) d = Vec3f(normal);
      Ray ray;
      ray.d = d;
      ray.o = ray_origin(point, Vec3d(d));
      rays.push_back(ray);
    }
    std::vector<Hit> hits(rays.size());
    render::closest_hits(*tree, rays, hits);
    for (const Hit& hit : hits) {
      lost += hit.id == render::kNoHit ? 1U : 0U;
      self += hit.id < 2 ? 1U : 0U;
    }
    n += hits.size();
  }
  row.never("second sheet missed", lost, n);
  row.never("self-hits", self, n);
  EXPECT_EQ(lost, 0U);
  EXPECT_EQ(self, 0U);
}

// ---- V07: shadow rays ----

// Square receiver, light above it, and one more square at `height` (none where it is 0).
struct ShadowCase {
  double distance = 1.0;
  double height = 0.0;  // of the second square, in units of the distance
  Similarity place;
};

// Receivers out of n that see the light.
std::uint64_t lit_receivers(const ShadowCase& c, std::uint64_t n, TestRandom& random) {
  const auto d = static_cast<float>(c.distance);
  TestMesh mesh = test::coplanar_grid(1, 2, 0.0F, 0.1F * d);
  if (c.height != 0.0) {
    mesh.append(test::coplanar_grid(1, 2, static_cast<float>(c.height * c.distance), d));
  }
  apply(c.place, mesh);
  const Vec3f light = c.place(Vec3f(0.0F, 0.0F, d));
  const auto tree = build(mesh);
  const auto shading = scene_mesh(mesh);
  std::vector<render::PathResult> results(n);
  render::RenderStats stats;
  render::ShadowQueue queue;
  for (std::uint64_t i = 0; i < n; ++i) {
    const Barycentrics b = random_barycentrics(random);
    const SurfacePoint point =
        surface_point(shading, static_cast<std::uint32_t>(i % 2), b.u, b.v);
    const Vec3d wi = render::normalize(Vec3d(light) - point.p);
    queue.push({ray_origin(point, wi), light, render::ShadowEnd::kPointLight}, render::Rgbd(1.0),
               static_cast<std::uint32_t>(i));
  }
  queue.flush(*tree, render::Traversal::kTree, results, stats);
  std::uint64_t lit = 0;
  for (const auto& result : results) lit += result.direct.x == 1.0 ? 1U : 0U;
  return lit;
}

TEST(V07_ShadowEnds, OccludersNearBothEndsAndAWallBehind) {
  Row row("V07", "light at D = 1, 1e3, 1e6; occluder at 1e-5 D, 0.5 D, (1 - 1e-5) D; or a wall "
          "1e-6 D behind the light; as is and turned",
          "all three occluders block; the wall behind does not");
  TestRandom random(701);
  const std::uint64_t n = trials(100'000, 2'000'000) / 2;
  std::uint64_t leaked = 0, wrongly_dark = 0, blocked_rays = 0, free_rays = 0;
  for (const double distance : {1.0, 1e3, 1e6}) {
    for (const bool turned : {false, true}) {
      ShadowCase c;
      c.distance = distance;
      if (turned) c.place = random_rotation(random);
      for (const double fraction : {1e-5, 0.5, 1.0 - 1e-5}) {
        c.height = fraction;
        leaked += lit_receivers(c, n, random);
        blocked_rays += n;
      }
      for (const double fraction : {0.0, 1.0 + 1e-6}) {
        c.height = fraction;
        wrongly_dark += n - lit_receivers(c, n, random);
        free_rays += n;
      }
    }
  }
  row.never("light through an occluder", leaked, blocked_rays);
  row.never("shadow of what is behind", wrongly_dark, free_rays);
  EXPECT_EQ(leaked, 0U);
  EXPECT_EQ(wrongly_dark, 0U);
}

// Rays from around to points on a pair of triangles, as emitters are asked for; `gap` > 0 puts a larger
// sheet so far before them. Counts those that get through. Origins have the clearance that the renderer
// gives them: closer to the plane, it is a matter of rounding on which side they are.
std::uint64_t lit_from_emitter(const Similarity& place, double distance, double gap, std::uint64_t n,
                               TestRandom& random) {
  TestMesh mesh = test::coplanar_grid(1, 2, 0.0F, 1.0F);
  if (gap > 0.0) mesh.append(test::coplanar_grid(1, 2, static_cast<float>(gap), 4.0F));
  apply(place, mesh);
  const auto tree = build(mesh);
  const auto shading = scene_mesh(mesh);
  std::vector<render::PathResult> results(n);
  render::RenderStats stats;
  render::ShadowQueue queue;
  for (std::uint64_t i = 0; i < n; ++i) {
    const Barycentrics b = random_barycentrics(random);
    const SurfacePoint point = surface_point(shading, static_cast<std::uint32_t>(i % 2), b.u, b.v);
    // Any angle over the sheet, down to 1e-6 of grazing; a sheet before it is met within its borders.
    const double low = gap > 0.0 ? 0.5 : 1e-6;
    const double height = std::pow(low, static_cast<double>(random.uniform()));
    const double turn = 6.283185307179586 * static_cast<double>(random.uniform());
    const double flat = std::sqrt(1.0 - height * height);
    const Vec3d towards = flat * std::cos(turn) * place.columns[0] +
                          flat * std::sin(turn) * place.columns[1] + height * place.columns[2];
    Vec3f from(point.p + distance * place.scale * towards);
    const double over = dot(point.ng, Vec3d(from) - point.p);
    if (std::abs(over) < 4.0 * point.clearance) {
      from = Vec3f(Vec3d(from) + std::copysign(4.0 * point.clearance, over) * point.ng);
    }
    queue.push({from, ray_end(point, Vec3d(from)), render::ShadowEnd::kSurface}, render::Rgbd(1.0),
               static_cast<std::uint32_t>(i));
  }
  queue.flush(*tree, render::Traversal::kTree, results, stats);
  std::uint64_t lit = 0;
  for (const auto& result : results) lit += result.direct.x == 1.0 ? 1U : 0U;
  return lit;
}

TEST(V07_ShadowEnds, EmittersOfAnySizeAndPlace) {
  Row row("V07", "60 emitters of size 10^U(-4,4), up to 100 sizes off the origin, seen from 0.1 to 1e5 sizes "
          "under any angle down to 1e-6; or behind a sheet, 1e-5 of the way and 30 clearances before them",
          "an emitter never blocks itself; the sheet always does");
  TestRandom random(702);
  const std::uint64_t n = trials(1'000'000, 10'000'000) / 60;
  std::uint64_t wrongly_dark = 0, leaked = 0, rays = 0;
  for (int member = 0; member < 60; ++member) {
    const Similarity place = random_similarity(random, member % 3 == 0 ? 0.0 : 100.0);
    const double distance = std::pow(10.0, static_cast<double>(random.uniform(-1.0F, 5.0F)));
    wrongly_dark += n - lit_from_emitter(place, distance, 0.0, n, random);
    // Clearance: gamma_7 |p| + gamma_4 of the size, below 1e-4 of it 100 sizes off.
    leaked += lit_from_emitter(place, distance, 3e-3 + 1e-5 * distance, n, random);
    rays += n;
  }
  row.never("dark by itself", wrongly_dark, rays);
  row.never("light through the sheet", leaked, rays);
  EXPECT_EQ(wrongly_dark, 0U);
  EXPECT_EQ(leaked, 0U);
}

// ---- V14: concave corners ----

// A point on triangle `id` within 2 ulp of one of its edges, or of a corner of it.
Barycentrics near_border(TestRandom& random, std::uint64_t kind) {
  const double tiny = static_cast<double>(random.below(3)) * 0x1p-23;
  const double along = static_cast<double>(random.uniform());
  switch (kind % 6) {
    case 0: return {tiny, along * (1.0 - tiny)};
    case 1: return {along * (1.0 - tiny), tiny};
    case 2: return {along * (1.0 - tiny), (1.0 - along) * (1.0 - tiny)};
    case 3: return {tiny, tiny};
    case 4: return {1.0 - tiny, 0.5 * tiny};
    default: return {0.5 * tiny, 1.0 - tiny};
  }
}

// Cosine-distributed about n.
Vec3f cosine_direction(TestRandom& random, const Vec3f& n) {
  const double u = static_cast<double>(random.uniform());
  const double phi = 2.0 * std::numbers::pi * static_cast<double>(random.uniform());
  const double r = std::sqrt(u);
  return render::Frame(n).to_world(Vec3f(Vec3d(r * std::cos(phi), r * std::sin(phi),
                                               std::sqrt(1.0 - u))));
}

struct CornerCount {
  std::uint64_t rays = 0, escapes = 0;
};

CornerCount corner_escapes(const TestMesh& mesh, const Vec3f& centre, std::uint64_t n,
                           std::uint64_t seed) {
  const auto tree = build(mesh);
  const auto shading = scene_mesh(mesh);
  TestRandom random(seed);
  CornerCount count;
  std::uint64_t kind = 0;
  trace_batches(
      *tree, n,
      [&] {
        const auto id = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
        const Barycentrics b = near_border(random, kind++);
        const SurfacePoint point = surface_point(shading, id, b.u, b.v);
        const double side = render::dot(point.ng, Vec3d(centre) - point.p) < 0.0 ? -1.0 : 1.0;
        Ray ray;
        ray.d = cosine_direction(random, Vec3f(side * point.ng));
        ray.o = ray_origin(point, Vec3d(ray.d));
        return ray;
      },
      [&](const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
        count.rays += rays.size();
        count.escapes += hits.size() - test::count_hits(hits);
      });
  return count;
}

TEST(V14_ConcaveCorners, UnitBox) {
  Row row("V14", "closed unit box, also scaled by powers of two; points within 2 ulp of its 12 edges "
          "and 8 corners, cosine directions", "every spawned ray hits the box");
  const std::uint64_t each = trials(1'000'000, 10'000'000) / 4;
  CornerCount total;
  for (const float scale : {1.0F, 0x1p-30F, 0x1p20F, 2.0F}) {
    const auto count = corner_escapes(cube(Vec3f(0.0F), Vec3f(scale)), Vec3f(0.5F * scale), each,
                                      1401);
    total.rays += count.rays;
    total.escapes += count.escapes;
  }
  row.never("escapes", total.escapes, total.rays);
  EXPECT_EQ(total.escapes, 0U);
}

TEST(V14_ConcaveCorners, TurnedBoxes) {
  Row row("V14", "40 boxes turned at random, scaled by 10^+-4, moved by up to 10 sizes; points within "
          "2 ulp of edges and corners", "every spawned ray hits the box");
  TestRandom random(1402);
  const std::uint64_t each = trials(1'000'000, 10'000'000) / 40;
  CornerCount total;
  for (int member = 0; member < 40; ++member) {
    const Similarity place = random_similarity(random, member < 20 ? 0.0 : 10.0);
    TestMesh mesh = cube(Vec3f(-0.5F), Vec3f(0.5F));
    apply(place, mesh);
    const auto count = corner_escapes(mesh, place(Vec3f(0.0F)), each, random.bits());
    total.rays += count.rays;
    total.escapes += count.escapes;
  }
  row.never("escapes", total.escapes, total.rays);
  EXPECT_EQ(total.escapes, 0U);
}

}  // namespace
}  // namespace raykiln::hard
