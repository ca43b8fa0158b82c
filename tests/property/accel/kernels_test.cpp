// The lane kernels are the scalar walk: the same hits and the same counts, whatever else is in the
// stream, at every scale a float can have.
#include <algorithm>

#include "same_counts.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::Hit;
using render::Occlusion;
using render::Ray;
using render::Traversal;
using render::TraversalCounters;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<TestMesh> meshes() {
  TestMesh doubled = coplanar_grid(6);
  doubled.append(soup(200, 5, 4.0F));
  doubled.append(doubled);
  // For trees that all rays walk sorted, that only any-hit rays do, and that no cache need hold: see
  // MeetEveryKindOfTree.
  return {soup(2500, 1, 2.0F), terrain(40), soup(300, 2, 2.0F), slivers(150), hair(20, 8), doubled,
          soup(40, 3, 2.0F), soup(60, 4, 2.0F), terrain(132)};
}

struct Answers {
  std::vector<Hit> hits;
  std::vector<Occlusion> occlusion;
  TraversalCounters closest, any;
};

Answers ask(const render::KdTree& tree, std::span<const Ray> rays, Traversal walk) {
  Answers answers;
  answers.hits.resize(rays.size());
  answers.occlusion.resize(rays.size());
  render::closest_hits(tree, rays, answers.hits, {}, walk, &answers.closest);
  render::any_hits(tree, rays, answers.occlusion, walk, &answers.any);
  return answers;
}

void expect_same(const render::KdTree& tree, const std::vector<Ray>& rays) {
  for (const render::TriangleTest test : kTriangleTests) {
    const Answers scalar = ask(tree, rays, render::with_test(Traversal::kScalar, test));
    for (const Traversal walk : walks(test)) {
      SCOPED_TRACE(render::name(walk));
      const Answers other = ask(tree, rays, walk);
      EXPECT_EQ(count_differences(rays, other.hits, scalar.hits), 0U);
      EXPECT_EQ(other.occlusion, scalar.occlusion);
      expect_same_counts(other.closest, scalar.closest);
      expect_same_counts(other.any, scalar.any);
    }
  }
}

void expect_brute_force(const render::KdTree& tree, const std::vector<Ray>& rays) {
  for (const render::TriangleTest test : kTriangleTests) {
    const auto expected = closest(tree, rays, brute_force(test));
    for (const Traversal walk : walks(test)) {
      SCOPED_TRACE(render::name(walk));
      EXPECT_EQ(count_differences(rays, closest(tree, rays, walk), expected), 0U);
    }
  }
}

// Again, beyond the first hit.
void expect_brute_force_beyond(const render::KdTree& tree, const std::vector<Ray>& rays,
                               render::TriangleTest test) {
  std::vector<render::HitOrder> after;
  for (const Hit& hit : closest(tree, rays, brute_force(test))) {
    after.push_back(hit.id == render::kNoHit ? render::HitOrder{} : render::HitOrder{hit.t, hit.id});
  }
  std::vector<Hit> beyond(rays.size());
  std::vector<Hit> found(rays.size());
  render::closest_hits(tree, rays, beyond, after, brute_force(test));
  for (const Traversal walk : walks(test)) {
    render::closest_hits(tree, rays, found, after, walk);
    EXPECT_EQ(count_differences(rays, found, beyond), 0U) << render::name(walk);
  }
}

// The walk does not depend on what it finds, but on the number of nodes: all its ways are to be taken here.
TEST(Kernels, MeetEveryKindOfTree) {
  std::vector<std::size_t> nodes;
  for (const TestMesh& mesh : meshes()) nodes.push_back(build(mesh, {})->nodes.size());
  const auto some = [&](std::size_t least, std::size_t most) {
    return std::any_of(nodes.begin(), nodes.end(), [&](std::size_t n) { return n >= least && n <= most; });
  };
  EXPECT_TRUE(some(3, 32));
  EXPECT_TRUE(some(33, 128));
  EXPECT_TRUE(some(1024, 8192));
  EXPECT_TRUE(some(16385, 100'000));
}

TEST(Kernels, CountWhatTheScalarWalkCounts) {
  for (const TestMesh& mesh : meshes()) {
    for (const int width : {8, 16}) {
      for (const double k_i : {0.25, 4.0}) {
        render::BuildParams params;
        params.leaf_width = width;
        params.k_i = k_i;
        const auto tree = build(mesh, params);
        expect_same(*tree, hard_rays(*tree, mesh, 1500, 40));
      }
    }
  }
}

// Rays that go together for a while: from one point or side by side, spread a little or a lot, also
// along the axes, where directions have zeros of either sign.
std::vector<Ray> beams(const render::KdTree& tree, std::uint64_t seed) {
  TestRandom random(seed);
  const render::Bounds3f box = render::bounds(tree);
  const float size = render::length(box.hi - box.lo);
  std::vector<Ray> rays;
  for (int beam = 0; beam < 40; ++beam) {
    const float spread = std::ldexp(1.0F, -static_cast<int>(random.below(12)));
    const Vec3f target = box.lo + (box.hi - box.lo) * random.in_box(0.0F, 1.0F);
    Vec3f along = random.direction();
    if (beam % 5 == 0) along = Vec3f(0.0F, beam % 2 == 0 ? 1.0F : -1.0F, -0.0F);
    const bool side_by_side = random.below(2) == 0;
    const std::size_t n = 1 + random.below(64);
    for (std::size_t i = 0; i < n; ++i) {
      Ray ray;
      const Vec3f aside = random.direction() * (random.below(4) == 0 ? 0.0F : spread);
      ray.o = target - along * size + (side_by_side ? aside * size : Vec3f(0.0F));
      ray.d = side_by_side ? along : along + aside;
      if (random.below(8) == 0) ray.t_max = size * random.uniform(0.5F, 1.5F);
      if (random.below(8) == 0) ray.t_min = size * random.uniform(0.5F, 1.2F);
      rays.push_back(ray);
    }
  }
  return rays;
}

TEST(Kernels, RaysThatGoTogetherAndPart) {
  std::uint64_t seed = 50;
  for (const TestMesh& mesh : meshes()) {
    std::vector<std::uint8_t> opaque(mesh.triangles.size());
    for (std::size_t i = 0; i < opaque.size(); ++i) opaque[i] = i % 3 == 0 ? 1 : 0;
    for (const int width : {8, 16}) {
      render::BuildParams params;
      params.leaf_width = width;
      params.k_i = width == 8 ? 1.0 : 0.25;
      render::TriangleView view = mesh.view();
      if (width == 8) view.opaque = opaque;
      render::SerialTaskRunner runner;
      const auto tree = render::build_kdtree(view, params, runner);
      const auto rays = beams(*tree, ++seed);
      expect_same(*tree, rays);
      expect_brute_force(*tree, rays);
      for (const render::TriangleTest test : kTriangleTests) {
        expect_brute_force_beyond(*tree, rays, test);
      }
    }
  }
}

// Leaves of many blocks have a filter of their own, for rays in lanes and for those in packets.
TEST(Kernels, LeavesOfManyBlocks) {
  struct Case {
    TestMesh mesh;
    int depth;
    std::uint64_t least_nodes;  ///< trees of few nodes are walked otherwise
  };
  for (const Case& c : {Case{terrain(300), 11, 1025}, Case{soup(60'000, 3, 2.0F), 10, 1025},
                        Case{slivers(3000), 3, 1}}) {
    for (const int width : {8, 16}) {
      render::BuildParams params;
      params.leaf_width = width;
      params.max_depth = c.depth;
      const auto tree = build(c.mesh, params);
      EXPECT_GE(render::build_stats(*tree).nodes, c.least_nodes);
      expect_same(*tree, hard_rays(*tree, c.mesh, 400, 43));
      expect_same(*tree, beams(*tree, 44));
      const auto few = beams(*tree, 45);
      expect_brute_force(*tree, {few.begin(), few.begin() + 100});
    }
  }
}

TEST(Kernels, AnyLengthOfStream) {
  const TestMesh mesh = soup(600, 2, 2.0F);
  const auto tree = build(mesh);
  const auto rays = hard_rays(*tree, mesh, 160, 41);
  for (std::size_t n = 0; n <= rays.size(); ++n) {
    expect_same(*tree, {rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(n)});
  }
}

TEST(Kernels, EveryScale) {
  for (const TestMesh& mesh : meshes()) {
    const auto rays = hard_rays(*build(mesh), mesh, 240, 42);
    for (const int exponent : {-100, -75, -63, -40, -12, 12, 40, 61, 62, 63, 64, 65, 75, 100}) {
      const float scale = std::ldexp(1.0F, exponent);
      TestMesh scaled = mesh;
      for (Vec3f& p : scaled.positions) p *= scale;
      const auto tree = build(scaled);
      std::vector<Ray> scaled_rays = rays;
      for (std::size_t i = 0; i < scaled_rays.size(); ++i) {  // t grows, or the direction
        Ray& ray = scaled_rays[i];
        ray.o *= scale;
        if (i % 24 < 12) {
          ray.d *= scale;
        } else {
          ray.t_min *= scale;
          ray.t_max *= scale;
        }
      }
      SCOPED_TRACE(exponent);
      expect_same(*tree, scaled_rays);
      expect_brute_force(*tree, scaled_rays);
      const auto expected = closest(*tree, scaled_rays);
      for (std::size_t i = 0; i < scaled_rays.size(); ++i) {  // intervals that end at the hit
        if (expected[i].id == render::kNoHit) continue;
        Ray& ray = scaled_rays[i];
        switch (i % 4) {
          case 0: ray.t_max = expected[i].t; break;
          case 1: ray.t_max = render::next_down(expected[i].t); break;
          case 2: ray.t_min = expected[i].t; break;
          default: ray.t_min = render::next_up(expected[i].t); break;
        }
      }
      expect_same(*tree, scaled_rays);
    }
  }
}

TEST(Kernels, RaysThatAreNotRaysAmongOthers) {
  const TestMesh mesh = soup(600, 3, 2.0F);
  const auto tree = build(mesh);
  auto rays = hard_rays(*tree, mesh, 4000, 43);
  TestRandom random(44);
  const std::vector<float> bad{kNan, kInf, -kInf, 0.0F, -0.0F, 1e-40F, 1e35F, -1e35F};
  for (Ray& ray : rays) {
    const float value = bad[random.below(static_cast<std::uint32_t>(bad.size()))];
    switch (random.below(8)) {
      case 0: ray.o[static_cast<int>(random.below(3))] = value; break;
      case 1: ray.d[static_cast<int>(random.below(3))] = value; break;
      case 2: ray.t_min = value; break;
      case 3: ray.t_max = value; break;
      case 4: ray.d = Vec3f(value); break;
      default: break;
    }
  }
  expect_same(*tree, rays);
  expect_brute_force(*tree, rays);
}

// An interval of one point is met where the hit lies and nowhere beside.
TEST(Kernels, IntervalsOfOnePoint) {
  for (const TestMesh& mesh : meshes()) {
    const auto tree = build(mesh);
    for (const render::TriangleTest test : kTriangleTests) {
      auto rays = hard_rays(*tree, mesh, 2000, 45);
      const auto hits = closest(*tree, rays, render::with_test(Traversal::kScalar, test));
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].id == render::kNoHit) continue;
        rays[i].t_min = rays[i].t_max = i % 4 == 0 ? render::next_up(hits[i].t) : hits[i].t;
      }
      expect_same(*tree, rays);
      const auto found = closest(*tree, rays, render::with_test(Traversal::kTree, test));
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (i % 4 == 0 || hits[i].id == render::kNoHit) continue;
        ASSERT_TRUE(same_bits(found[i], hits[i])) << "ray " << i;
      }
    }
  }
}

TEST(Kernels, ATreeOfNothing) {
  const auto tree = build(TestMesh{});
  expect_same(*tree, std::vector<Ray>(100));
}

TEST(Kernels, HaveNamesAndGiveWay) {
  for (const render::TriangleTest test : kTriangleTests) {
    const auto tested = [&](Traversal walk) { return render::with_test(walk, test); };
    for (const Traversal walk : walks(test)) {
      EXPECT_EQ(render::traversal_named(render::name(walk)), walk);
      EXPECT_EQ(render::resolve(walk), walk);
      EXPECT_EQ(render::test_of(walk), test);
    }
    EXPECT_EQ(render::resolve(brute_force(test)), brute_force(test));
    const Traversal chosen = render::resolve(tested(Traversal::kTree));
    EXPECT_NE(chosen, tested(Traversal::kTree));
    EXPECT_EQ(chosen, tested(render::resolve(Traversal::kTree)));
    EXPECT_TRUE(render::is_available(chosen));
    for (const Traversal kernel : {tested(Traversal::kAvx2), tested(Traversal::kAvx512)}) {
      const bool runs = render::is_available(kernel);
      EXPECT_EQ(render::resolve(kernel), runs ? kernel : tested(Traversal::kScalar));
    }
  }
  EXPECT_EQ(render::traversal_named("sse"), std::nullopt);
}

}  // namespace
}  // namespace raykiln::test
