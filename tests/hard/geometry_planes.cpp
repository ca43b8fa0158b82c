// K01, K02: walls in split planes, scenes without thickness.
#include "hard/support/build_work.hpp"
#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"
#include "hard/support/turns.hpp"

namespace raykiln::hard {
namespace {

using render::build_stats;
using test::build;

Ray ray_from(const Vec3f& o, const Vec3f& d) {
  Ray ray;
  ray.o = o;
  ray.d = d;
  return ray;
}

// ---- K01: a wall of n x n quads in the plane axis = at, in a box of six quads ----

struct Wall {
  int axis = 0;
  float at = 1.7F;
  std::uint32_t n = 100;
  float unit = 1.0F;  // the box is [-3 unit, 3 unit]^3
};

TestMesh walled_box(const Wall& wall) {
  TestMesh mesh = test::box_room(1, 3.0F * wall.unit);
  TestMesh sheet = test::coplanar_grid(wall.n, wall.axis, wall.at * wall.unit, 3.0F * wall.unit);
  mesh.append(sheet);
  return mesh;
}

Ray ray_at_wall(const Wall& wall, TestRandom& random) {
  Vec3f d = random.direction();
  if (!(d[wall.axis] > 0.0F)) d[wall.axis] = -d[wall.axis];
  if (d[wall.axis] == 0.0F) d[wall.axis] = 1e-3F;
  return ray_from(wall.unit * random.in_box(-1.0F, 1.0F), d);
}

Tally rays_at_wall(const Wall& wall, std::uint64_t n, std::uint64_t seed) {
  const auto tree = build(walled_box(wall));
  TestRandom random(seed);
  return trace_and_compare(*tree, n, n, [&] { return ray_at_wall(wall, random); });
}

// A share of a mesh, in the mesh's order, so that the lowest id of it is the lowest of all.
struct Excerpt {
  TestMesh mesh;
  std::vector<std::uint32_t> ids;
  std::shared_ptr<const KdTree> tree;
};

// Brute force over what a ray can meet: the box, and of the wall x = 1.7 the 12 x 12 quads about the
// tenth by tenth of it that the ray crosses. Half a quad is 0.03 wide, the error of a hit 1e-6.
class WallExcerpts {
 public:
  explicit WallExcerpts(const TestMesh& mesh) {
    for (std::uint32_t i = 0; i < 100; ++i) excerpts_.push_back(about(mesh, i % 10, i / 10));
  }

  [[nodiscard]] std::size_t index_of(const Ray& ray) const {
    const double t = (static_cast<double>(Wall{}.at) - static_cast<double>(ray.o.x)) /
                     static_cast<double>(ray.d.x);
    const auto cell = [t](float o, float d) {
      const double at = static_cast<double>(o) + t * static_cast<double>(d);
      return static_cast<std::size_t>(std::clamp((at + 3.0) / 0.6, 0.0, 9.0));
    };
    return cell(ray.o.z, ray.d.z) * 10 + cell(ray.o.y, ray.d.y);
  }

  // Hits of the excerpt's rays, with the ids of the whole mesh.
  [[nodiscard]] std::vector<Hit> brute_force(std::size_t index, const std::vector<Ray>& rays) const {
    std::vector<Hit> hits(rays.size());
    const Excerpt& excerpt = excerpts_[index];
    render::closest_hits(*excerpt.tree, rays, hits, {}, render::Traversal::kBruteForce);
    for (Hit& hit : hits) {
      if (hit.id != render::kNoHit) hit.id = excerpt.ids[hit.id];
    }
    return hits;
  }

 private:
  static Excerpt about(const TestMesh& mesh, std::uint32_t iy, std::uint32_t iz) {
    const auto near = [](float x, std::uint32_t i) {
      const float lo = -3.0F + 0.6F * static_cast<float>(i);
      return x > lo - 0.07F && x < lo + 0.67F;
    };
    Excerpt excerpt;
    for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
      const auto p = mesh.corners(id);
      const bool of_the_box = std::abs(p[0].x) == 3.0F || std::abs(p[1].x) == 3.0F;
      const Vec3f middle = (p[0] + p[1] + p[2]) / 3.0F;
      if (!of_the_box && !(near(middle.y, iy) && near(middle.z, iz))) continue;
      excerpt.mesh.add(p[0], p[1], p[2]);
      excerpt.ids.push_back(id);
    }
    excerpt.tree = build(excerpt.mesh);
    return excerpt;
  }

  std::vector<Excerpt> excerpts_;
};

Tally rays_at_fine_wall(const KdTree& tree, const WallExcerpts& excerpts, std::uint64_t n,
                        TestRandom& random) {
  std::vector<std::vector<Ray>> rays(100);
  std::vector<std::vector<Hit>> found(100);
  Tally tally;
  trace_batches(tree, n, [&] { return ray_at_wall({}, random); },
                [&](const std::vector<Ray>& batch, const std::vector<Hit>& hits) {
                  tally.rays += hits.size();
                  tally.hits += test::count_hits(hits);
                  for (std::size_t i = 0; i < hits.size(); ++i) {
                    const std::size_t index = excerpts.index_of(batch[i]);
                    rays[index].push_back(batch[i]);
                    found[index].push_back(hits[i]);
                  }
                });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    tally.mismatches += test::count_differences(rays[i], found[i], excerpts.brute_force(i, rays[i]));
    tally.compared += rays[i].size();
  }
  return tally;
}

TEST(K01_CoplanarWalls, HundredByHundredQuads) {
  Row row("K01", "box [-3,3]^3, wall of 100 x 100 quads in x = float(1.7)",
          "every ray hits; hits equal brute force");
  const TestMesh mesh = walled_box({});
  const auto tree = build(mesh);
  const WallExcerpts excerpts(mesh);
  TestRandom random(101);
  Tally tally;
  for (std::uint64_t i = 0; i < trials(4, 40); ++i) {
    tally += rays_at_fine_wall(*tree, excerpts, all_trials(250'000), random);
  }
  row.never("misses", tally.rays - tally.hits, tally.rays);
  row.never("differences from brute force", tally.mismatches, tally.compared);
  EXPECT_EQ(tally.hits, tally.rays);
  EXPECT_EQ(tally.mismatches, 0U);
}

TEST(K01_CoplanarWalls, RandomWalls) {
  Row row("K01", "60 boxes of any size: random axis, position and grid of the wall",
          "every ray hits; hits equal brute force");
  TestRandom random(102);
  Tally total;
  for (int member = 0; member < 60; ++member) {
    Wall wall;
    wall.axis = member % 3;
    wall.at = random.uniform(1.01F, 2.99F);
    wall.n = std::array<std::uint32_t, 3>{1, 3, 9}[random.below(3)];
    wall.unit = std::pow(10.0F, random.uniform(-6.0F, 6.0F));
    const std::uint64_t n = trials(1'000'000, 10'000'000) / 60;
    total += rays_at_wall(wall, n, 1000 + static_cast<std::uint64_t>(member));
  }
  row.never("misses", total.rays - total.hits, total.rays);
  row.never("differences from brute force", total.mismatches, total.compared);
  EXPECT_EQ(total.hits, total.rays);
  EXPECT_EQ(total.mismatches, 0U);
}

// ---- K02: flat and line-shaped scenes ----

// n triangles with edges up to `edge` in the plane axis = height + thickness * random.
TestMesh flat_soup(std::uint32_t n, float edge, int axis, float height, float thickness,
                   TestRandom& random) {
  TestMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::array<Vec3f, 3> p;
    const Vec3f first = random.in_box(0.0F, 1.0F);
    for (Vec3f& q : p) {
      q = first + edge * random.in_box(-0.5F, 0.5F);
      q[axis] = height + thickness * random.uniform();
    }
    mesh.add(p[0], p[1], p[2]);
  }
  return mesh;
}

// Through the plane, parallel to it at a distance, and inside of it.
Ray ray_at_plane(TestRandom& random, int axis, float height, std::uint64_t kind) {
  Ray ray = ray_from(random.in_box(-0.5F, 1.5F), random.direction());
  switch (kind % 4) {
    case 0: ray.d[axis] = 0.0F; break;
    case 1:
      ray.d[axis] = (random.bits() & 1) != 0 ? 0.0F : -0.0F;
      ray.o[axis] = height;
      break;
    default: break;
  }
  return ray;
}

struct FlatResult {
  Tally tally;
  std::uint64_t in_plane_hits = 0;
  double references = 0.0;  // a triangle
  double work = 0.0;        // of the build
  bool budget_reached = false;
};

FlatResult check_flat(const TestMesh& mesh, int axis, float height, bool exactly_flat,
                      std::uint64_t rays, std::uint64_t seed) {
  FlatResult result;
  const auto tree = build(mesh);
  const auto& stats = build_stats(*tree);
  result.references =
      static_cast<double>(stats.references) / static_cast<double>(stats.triangles);
  result.budget_reached = stats.splits_over_budget > 0;
  result.work = work_of(stats);
  TestRandom random(seed);
  std::uint64_t kind = 0;
  result.tally = trace_and_compare(*tree, rays, rays,
                                   [&] { return ray_at_plane(random, axis, height, kind++); });
  if (!exactly_flat) return result;
  trace_batches(
      *tree, rays, [&] { return ray_at_plane(random, axis, height, 1); },
      [&](const auto&, const auto& hits) { result.in_plane_hits += test::count_hits(hits); });
  return result;
}

TEST(K02_FlatScenes, SparseSheetBuildsLikeAnyOtherScene) {
  Row row("K02", "(a) 1e4 triangles, edge 0.7/sqrt(N), in a plane across x, y or z",
          "build <= 2x a 3-D scene, by counted work and time; references <= 3N; hits equal brute force; none in the plane");
  constexpr std::uint32_t kN = 10'000;
  constexpr double kSlowest = 2.0;
  const TestMesh solid = test::soup(kN, 3);
  const double work_of_solid = work_of(build_stats(*build(solid)));
  double slowest = 0.0, most_work = 0.0, most = 0.0;
  Tally total;
  std::uint64_t in_plane = 0;
  TestRandom random(201);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float height : {0.0F, 0.7F, -12345.0F}) {
      const auto mesh = flat_soup(kN, 0.007F, axis, height, 0.0F, random);
      const FlatResult r = check_flat(mesh, axis, height, true, trials(4000, 40'000), random.bits());
      Turns turns;
      most_work = std::max(most_work, r.work / work_of_solid);
      while (!turns.enough(3, 100, kSlowest)) turns.group(1, [&] { build(solid); }, [&] { build(mesh); });
      slowest = std::max(slowest, turns.ratio());
      most = std::max(most, r.references);
      total += r.tally;
      in_plane += r.in_plane_hits;
    }
  }
  row.measured("work against 3-D", most_work);
  row.measured("time", slowest);
  row.measured("references/N", most);
  row.never("differences", total.mismatches, total.compared);
  row.measured("hits in the plane", in_plane);
  EXPECT_LE(most_work, kSlowest);
  EXPECT_LE(slowest, kSlowest);
  EXPECT_LE(most, 3.0);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_EQ(in_plane, 0U);
}

// Few triangles, so that every one of very many rays can be compared.
TEST(K02_FlatScenes, SmallSheets) {
  Row row("K02", "50 sheets of 20 to 120 triangles in or near a plane (thickness 0, 1e-45 to 1e-12), sparse and "
          "overlapping; 1e6 rays", "hits equal brute force; none in the plane");
  TestRandom random(206);
  Tally total;
  std::uint64_t in_plane = 0;
  const std::uint64_t each = trials(1'000'000, 10'000'000) / 50;
  for (int member = 0; member < 50; ++member) {
    const bool flat = member % 2 == 0;
    const float thickness = flat ? 0.0F : std::pow(10.0F, random.uniform(-45.0F, -12.0F));
    const float height = member % 4 == 0 ? 0.0F : random.uniform();
    const auto n = 20 + random.below(100);
    const auto mesh = flat_soup(n, random.uniform(0.05F, 1.0F), member % 3, height, thickness, random);
    const FlatResult r = check_flat(mesh, member % 3, height, flat, each, random.bits());
    total += r.tally;
    in_plane += r.in_plane_hits;
  }
  row.never("differences", total.mismatches, total.compared);
  row.measured("hits in the plane", in_plane);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_EQ(in_plane, 0U);
  EXPECT_GT(total.hits, total.rays / 100);
}

TEST(K02_FlatScenes, OverlappingSheetStopsAtTheBudget) {
  Row row("K02", "(a2) 1e4 triangles, edge 0.05, overlapping in one plane",
          "references within the budget, said when reached; hits equal brute force");
  TestRandom random(202);
  const auto mesh = flat_soup(10'000, 0.05F, 2, 0.0F, 0.0F, random);
  const FlatResult r = check_flat(mesh, 2, 0.0F, true, trials(10'000, 100'000), 203);
  row.measured("references/N", r.references);
  row.measured("budget reached", r.budget_reached ? "yes" : "no");
  row.never("differences", r.tally.mismatches, r.tally.compared);
  EXPECT_LE(r.references, render::BuildParams{}.max_duplication);
  EXPECT_TRUE(r.budget_reached);
  EXPECT_EQ(r.tally.mismatches, 0U);
  EXPECT_EQ(r.in_plane_hits, 0U);
}

TEST(K02_FlatScenes, AlmostFlat) {
  Row row("K02", "(b) 1e4 triangles with z = s rand, s = 1e-30, 1e-38, 1e-45, 1e-12",
          "build ends; hits equal brute force");
  TestRandom random(204);
  Tally total;
  for (const float thickness : {1e-30F, 1e-38F, 1e-45F, 1e-12F}) {
    const auto mesh = flat_soup(10'000, 0.007F, 2, 0.0F, thickness, random);
    total += check_flat(mesh, 2, 0.0F, false, trials(4000, 40'000), random.bits()).tally;
  }
  row.never("differences", total.mismatches, total.compared);
  row.never("hits", total.hits, total.rays);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_GT(total.hits, 0U);
}

TEST(K02_FlatScenes, LineAndSingleTriangles) {
  Row row("K02", "(c) 1e3 triangles on a line along x, y, z; (d) single triangles",
          "build ends; all of (c) dropped and counted; hits equal brute force");
  TestRandom random(205);
  std::uint64_t dropped = 0;
  Tally total;
  for (int axis = 0; axis < 3; ++axis) {
    TestMesh line;
    for (int i = 0; i < 1000; ++i) {
      std::array<Vec3f, 3> p{Vec3f(0.0F), Vec3f(0.0F), Vec3f(0.0F)};
      for (Vec3f& q : p) q[axis] = random.uniform(-1.0F, 1.0F);
      line.add(p[0], p[1], p[2]);
    }
    const auto tree = build(line);
    dropped += build_stats(*tree).dropped_degenerate;
    EXPECT_EQ(trace_and_compare(*tree, 1000, 1000, [&] {
                return test::ray_to(random.in_box(-1.0F, 1.0F), line.positions[random.below(3000)]);
              }).hits, 0U);
  }
  for (int member = 0; member < 1000; ++member) {
    TestMesh one;
    const float size = std::pow(10.0F, random.uniform(-15.0F, 15.0F));
    one.add(size * random.in_box(-1.0F, 1.0F), size * random.in_box(-1.0F, 1.0F),
            size * random.in_box(-1.0F, 1.0F));
    const auto tree = build(one);
    total += trace_and_compare(*tree, 100, 100, [&] {
      return test::ray_to(size * random.in_box(-1.0F, 1.0F),
                          test::point_on(random, one.corners(0)));
    });
  }
  row.never("dropped", dropped, 3000);
  row.never("single triangle: differences", total.mismatches, total.compared);
  EXPECT_EQ(dropped, 3000U);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_GT(total.hits, total.rays / 2);
}

}  // namespace
}  // namespace raykiln::hard
