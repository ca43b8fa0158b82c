// V03, V04, V05, V11, V12, V15: rays that leak, that stop too early, that start at the border, and
// rays that are none.
#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"

namespace raykiln::hard {
namespace {

using render::make_inner;
using render::make_leaf;
using test::build;

Ray normalised_ray_to(const Vec3f& o, const Vec3f& target) {
  Ray ray = test::ray_to(o, target);
  const float longest = std::max({std::abs(ray.d.x), std::abs(ray.d.y), std::abs(ray.d.z)});
  ray.d = render::normalize(ray.d / longest);  // 1e-4 squared may not underflow
  return ray;
}

// ---- V03, V04: watertight at edges and vertices ----

enum class Aim { kEdge, kVertex };

Vec3f aim_point(TestRandom& random, const TestMesh& mesh, Aim aim) {
  const auto n = static_cast<std::uint32_t>(mesh.triangles.size());
  const auto corners = mesh.corners(random.below(n));
  const std::size_t first = random.below(3);
  if (aim == Aim::kVertex) return corners[first];
  const Vec3f along = corners[(first + 1) % 3] - corners[first];
  return corners[first] + along * random.uniform();
}

std::uint64_t leaks(const ClosedMesh& closed, Aim aim, std::uint64_t n, std::uint64_t seed) {
  const auto tree = build(closed.mesh);
  TestRandom random(seed);
  std::uint64_t missed = 0;
  const auto inside = static_cast<std::uint32_t>(closed.inside.size());
  trace_batches(
      *tree, n,
      [&] {
        return normalised_ray_to(closed.inside[random.below(inside)],
                                 aim_point(random, closed.mesh, aim));
      },
      [&](const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
        for (std::size_t i = 0; i < hits.size(); ++i) {
          if (hits[i].id != render::kNoHit) continue;
          if (++missed > 3) continue;
          const Ray& r = rays[i];
          ADD_FAILURE() << std::hexfloat << closed.name << ": o " << r.o.x << ' ' << r.o.y << ' '
                        << r.o.z << " d " << r.d.x << ' ' << r.d.y << ' ' << r.d.z;
        }
      });
  return missed;
}

enum class Place { kAsIs, kMoved };

// One test for the meshes as they are and one for copies: two processors share the long run.
void expect_watertight(const char* id, Aim aim, Place place) {
  Row row(id,
          std::string("cube, icosphere 20k, torus 20k, bipyramids of valence 3 to 8, ") +
              (place == Place::kAsIs ? "as they are" : "turned, scaled by 10^+-4, moved by 10 sizes") +
              "; rays from inside",
          "at least one hit for every ray");
  TestRandom random(place == Place::kAsIs ? 301 : 302);
  const auto meshes = closed_meshes(random);
  const std::uint64_t members = meshes.size();
  const std::uint64_t each = (trials(500'000, 50'000'000) + members - 1) / members;
  std::uint64_t missed = 0;
  for (const ClosedMesh& closed : meshes) {
    const ClosedMesh& member =
        place == Place::kAsIs ? closed : apply(random_similarity(random, 10.0), closed);
    missed += leaks(member, aim, each, random.bits());
  }
  row.never("leaks", missed, each * members);
  EXPECT_EQ(missed, 0U);
}

TEST(V03_WatertightEdges, AsTheyAre) { expect_watertight("V03", Aim::kEdge, Place::kAsIs); }
TEST(V03_WatertightEdges, Moved) { expect_watertight("V03", Aim::kEdge, Place::kMoved); }
TEST(V04_WatertightVertices, AsTheyAre) { expect_watertight("V04", Aim::kVertex, Place::kAsIs); }
TEST(V04_WatertightVertices, Moved) { expect_watertight("V04", Aim::kVertex, Place::kMoved); }

// ---- V05: watertight far from the origin ----

std::uint64_t escapes(const Vec3f& centre, float radius, std::uint64_t n, std::uint64_t seed) {
  const auto tree = build(test::sphere(400, 200, centre, radius));
  TestRandom random(seed);
  std::uint64_t missed = 0;
  trace_batches(
      *tree, n,
      [&] {
        Ray ray;
        ray.o = centre + 0.25F * radius * random.in_box(-1.0F, 1.0F);
        ray.d = random.direction();
        return ray;
      },
      [&](const auto&, const auto& hits) { missed += hits.size() - test::count_hits(hits); });
  return missed;
}

TEST(V05_FarFromTheOrigin, EmbreesPlace) {
  Row row("V05", "sphere of radius 2, 400 x 200, at (148376, 1234, -223423)", "no ray escapes");
  const std::uint64_t n = trials(1'000'000, 10'000'000);
  const std::uint64_t missed = escapes({148376.0F, 1234.0F, -223423.0F}, 2.0F, n, 501);
  row.never("escapes", missed, n);
  EXPECT_EQ(missed, 0U);
}

TEST(V05_FarFromTheOrigin, RandomPlaces) {
  Row row("V05", "6 spheres, radius 10^U(-3,3), centre up to 2^18 radii away", "no ray escapes");
  TestRandom random(502);
  const std::uint64_t n = trials(1'000'000, 10'000'000) / 6;
  std::uint64_t missed = 0;
  for (int member = 0; member < 6; ++member) {
    const float radius = std::pow(10.0F, random.uniform(-3.0F, 3.0F));
    const Vec3f centre = radius * 0x1p18F * random.in_box(-1.0F, 1.0F);
    missed += escapes(centre, radius, n, random.bits());
  }
  row.never("escapes", missed, 6 * n);
  EXPECT_EQ(missed, 0U);
}

// ---- V11: a hit found in a leaf but lying outside of it ----

// One block a leaf, filled with the triangles of `ids`.
render::LeafBlock<8> block_of(const TestMesh& mesh, const std::vector<std::uint32_t>& ids) {
  render::LeafBlock<8> block{};
  block.id.fill(render::kNoHit);
  for (std::size_t lane = 0; lane < ids.size(); ++lane) {
    block.id[lane] = ids[lane];
    const auto corners = mesh.corners(ids[lane]);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) block.v[c][static_cast<std::size_t>(k)][lane] = corners[c][k];
    }
  }
  return block;
}

TEST(V11_HitOutsideTheLeaf, HandMadeTree) {
  Row row("V11", "hand-made tree split at x = 1 (on every axis); A in both leaves, B in the far one",
          "B, t = 1.2");
  std::uint64_t wrong = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto turned = [&](const Vec3f& p) {
      Vec3f q;
      for (int k = 0; k < 3; ++k) q[(k + axis) % 3] = p[k];
      return q;
    };
    TestMesh mesh;
    mesh.add(turned({0.5F, -1, -1}), turned({2.5F, 1, -1}), turned({1.5F, 0, 2}));
    mesh.add(turned({1.2F, -1, -1}), turned({1.2F, 1, -1}), turned({1.2F, 1, 1}));
    mesh.add(turned({1.2F, -1, -1}), turned({1.2F, 1, 1}), turned({1.2F, -1, 1}));
    render::KdTree tree;
    for (const Vec3f& p : mesh.positions) tree.box.grow(p);
    tree.positions = mesh.positions;
    tree.triangles = mesh.triangles;
    tree.nodes = {make_inner(static_cast<std::uint32_t>(axis), 1.0F, 2), make_leaf(0, 0),
                  make_leaf(1, 0), make_leaf(1, 1)};
    tree.blocks8 = {block_of(mesh, {0}), block_of(mesh, {0, 1, 2})};
    Ray ray;
    ray.o = Vec3f(0.0F);
    ray.d = turned({1.0F, 0.0F, 0.0F});
    Hit hit;
    render::closest_hits(tree, std::span(&ray, 1), std::span(&hit, 1));
    wrong += hit.id == 1 && hit.t == 1.2F ? 0U : 1U;
  }
  row.never("wrong answers", wrong, 3);
  EXPECT_EQ(wrong, 0U);
}

TEST(V11_HitOutsideTheLeaf, LargeTriangles) {
  Row row("V11", "20 scenes of 50 to 1000 triangles as large as the scene; random rays",
          "hits equal brute force");
  TestRandom random(1101);
  Tally total;
  const std::uint64_t each = trials(1'000'000, 10'000'000) / 20;
  for (std::size_t member = 0; member < 20; ++member) {
    const std::size_t n = member < 5 ? 1000 : 50 + random.below(300);
    const TestMesh mesh = test::soup(n, random.bits(), std::cbrt(static_cast<float>(n)));
    const auto tree = build(mesh);
    total += trace_and_compare(*tree, each, each, [&] {
      Ray ray;
      ray.o = random.in_box(-0.5F, 1.5F);
      ray.d = random.direction();
      return ray;
    });
  }
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_GT(total.hits, total.rays / 2);
}

// ---- V12: origins on and outside of the root box ----

// Inward, outward, along faces and edges, and anything.
Vec3f border_direction(TestRandom& random, std::uint64_t kind) {
  Vec3f d = random.direction();
  for (int k = 0; k < 3; ++k) {
    const auto digit = kind % 3;
    if (digit == 1) d[k] = (random.bits() & 1) != 0 ? 0.0F : -0.0F;
    kind /= 3;
  }
  return d == Vec3f(0.0F) ? random.direction() : d;
}

TEST(V12_RootBox, OriginsOnFacesEdgesCornersAndFarOutside) {
  Row row("V12", "26 places on the root box of 8 meshes x 1e4 directions, and far outside with the "
          "box ahead or behind", "hits equal brute force");
  TestRandom random(1201);
  Tally total;
  std::vector<TestMesh> meshes{cube(Vec3f(-1.0F), Vec3f(1.0F)), test::soup(200, 1, 2.0F),
                               test::coplanar_grid(4), icosphere(1)};
  for (std::size_t i = 0; i < 4; ++i) {
    meshes.push_back(meshes[i]);
    apply(random_similarity(random, 3.0), meshes.back());
  }
  const std::uint64_t each = trials(10'000, 100'000);
  for (const TestMesh& mesh : meshes) {
    const auto tree = build(mesh);
    const auto box = render::bounds(*tree);
    std::uint64_t kind = 0;
    for (int place = 0; place < 27; ++place) {
      const std::array<int, 3> where{place % 3, place / 3 % 3, place / 9};
      total += trace_and_compare(*tree, each, each, [&] {
        Ray ray;
        for (int k = 0; k < 3; ++k) {
          const int w = where[static_cast<std::size_t>(k)];
          ray.o[k] = w == 0 ? box.lo[k]
                            : (w == 1 ? box.hi[k] : random.uniform(box.lo[k], box.hi[k]));
        }
        ray.d = border_direction(random, kind++);
        if (place == 26) ray.o = ray.o + ray.d * (10.0F * render::length(box.hi - box.lo));
        if (place == 26 && (kind & 1) != 0) ray.d = -ray.d;
        return ray;
      });
    }
  }
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.mismatches, 0U);
  EXPECT_GT(total.hits, total.rays / 10);
}

// ---- V15: rays that are none ----

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Ray spoilt(Ray ray, TestRandom& random, std::uint64_t kind) {
  const auto axis = static_cast<int>(random.below(3));
  const float bad = (random.bits() & 1) != 0 ? kInf : -kInf;
  switch (kind % 8) {
    case 0: ray.o[axis] = kNan; break;
    case 1: ray.o[axis] = bad; break;
    case 2: ray.d[axis] = kNan; break;
    case 3: ray.d[axis] = bad; break;
    case 4: ray.d = Vec3f((random.bits() & 1) != 0 ? 0.0F : -0.0F); break;
    case 5: ray.t_max = kNan; break;
    case 6: ray.t_max = -random.uniform(); break;
    default: ray.t_min = kNan; break;
  }
  return ray;
}

double seconds_of(const KdTree& tree, const std::vector<Ray>& rays, std::vector<Hit>& hits) {
  double best = 1e9;
  for (int i = 0; i < 5; ++i) {
    const double start = cpu_seconds();
    render::closest_hits(tree, rays, hits);
    best = std::min(best, cpu_seconds() - start);
  }
  return best;
}

TEST(V15_NonFiniteRays, MissInBoundedTime) {
  Row row("V15", "NaN, Inf and zero in every field of 1e6 rays, 3 meshes",
          "a miss, counted; time <= 2.5x a normal ray");
  TestRandom random(1501);
  std::uint64_t bad_hits = 0, bad_occluders = 0, steps = 0, n = 0, uncounted = 0;
  double worst = 0.0;
  for (const TestMesh& mesh : {test::terrain(100), icosphere(4), test::soup(10'000, 1)}) {
    const auto tree = build(mesh);
    const std::size_t count = trials(340'000, 3'400'000);
    std::vector<Ray> good(count), bad(count);
    for (std::size_t i = 0; i < count; ++i) {
      good[i] = test::ray_to(random.in_box(-2.0F, 2.0F), mesh.positions[random.below(1000)]);
      bad[i] = spoilt(good[i], random, i);
    }
    std::vector<Hit> hits(count);
    const double normal = seconds_of(*tree, good, hits);
    worst = std::max(worst, seconds_of(*tree, bad, hits) / normal);
    bad_hits += test::count_hits(hits);
    for (const Hit& hit : hits) bad_hits += hit.t == kInf ? 0U : 1U;
    std::vector<render::Occlusion> blocked(count);
    render::TraversalCounters counters;
    render::any_hits(*tree, bad, blocked, render::Traversal::kTree, &counters);
    for (const auto b : blocked) bad_occluders += b == render::Occlusion::kNone ? 0U : 1U;
    EXPECT_EQ(counters.rays, count);
    steps += counters.node_steps;
    uncounted += count - counters.unusable_rays;
    counters = {};
    render::closest_hits(*tree, std::span(bad).first(1000), hits, {},
                         render::Traversal::kBruteForce, &counters);
    uncounted += 1000 - counters.unusable_rays;
    render::closest_hits(*tree, std::span(good).first(1000), hits, {}, render::Traversal::kTree,
                         &counters);
    EXPECT_EQ(counters.unusable_rays, 1000U) << "good rays are not counted";
    render::closest_hits(*tree, std::span(bad).first(1000), hits);
    bad_hits += test::count_hits({hits.begin(), hits.begin() + 1000});
    n += count;
  }
  row.never("hits", bad_hits + bad_occluders, n);
  row.measured("time against a normal ray", worst);
  row.measured("node steps", steps);
  row.never("not counted", uncounted, n);
  EXPECT_EQ(bad_hits + bad_occluders, 0U);
  EXPECT_EQ(uncounted, 0U);
  EXPECT_LE(worst, 2.5);
}

// A tree as deep as any may be: the walk's stack holds it, whichever side is far.
TEST(V15_NonFiniteRays, DeepestTree) {
  Row row("V15", "hand-made trees of depth 64, split towards either side",
          "the stack bound holds; hits equal brute force");
  TestRandom random(1502);
  Tally total;
  for (const bool low_side : {true, false}) {
    TestMesh mesh;
    mesh.add({0, 0, 0}, {1, 1, 0}, {1, 0, 1});
    mesh.add({0, 1, 0}, {1, 1, 1}, {0.5F, 0, 1});
    render::KdTree tree;
    for (const Vec3f& p : mesh.positions) tree.box.grow(p);
    tree.positions = mesh.positions;
    tree.triangles = mesh.triangles;
    tree.blocks8 = {block_of(mesh, {0, 1})};
    std::array<Vec3f, 2> cell{Vec3f(0.0F), Vec3f(1.0F)};
    tree.nodes.assign(2, make_leaf(1, 0));
    std::size_t open = 0;
    for (std::uint32_t depth = 0; depth < render::kMaxKdDepth; ++depth) {
      const auto axis = static_cast<int>(depth % 3);
      const float split = 0.5F * (cell[0][axis] + cell[1][axis]);
      const auto left = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes.push_back(make_leaf(1, 0));
      tree.nodes.push_back(make_leaf(1, 0));
      tree.nodes[open] = make_inner(depth % 3, split, left);
      open = left + (low_side ? 0 : 1);
      cell[low_side ? 1 : 0][axis] = split;
    }
    total += trace_and_compare(tree, 50'000, 50'000, [&] {
      const Vec3f corner = low_side ? Vec3f(0.0F) : Vec3f(1.0F);
      return test::ray_to(random.in_box(-0.2F, 1.2F), corner + 1e-4F * random.in_box(-1.0F, 1.0F));
    });
  }
  row.never("differences", total.mismatches, total.compared);
  EXPECT_EQ(total.mismatches, 0U);
}

}  // namespace
}  // namespace raykiln::hard
