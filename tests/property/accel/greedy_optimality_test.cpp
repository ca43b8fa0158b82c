// The sweep finds the cheapest plane: recounted from the definition for every candidate.
#include "event_key.hpp"
#include "plane_search.hpp"
#include "sah_sweep.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::Bounds3f;
using render::BuildContext;
using render::BuildParams;
using render::EventKey;
using render::SplitPlane;

struct SmallSet {
  Bounds3f cell;
  std::vector<Bounds3f> extents;
};

SmallSet random_set(TestRandom& random, std::uint32_t most = 24) {
  SmallSet set;
  const std::uint32_t n = 1 + random.below(most);
  const bool on_grid = random.below(2) == 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    Bounds3f b;
    for (int corner = 0; corner < 2; ++corner) {
      Vec3f p = random.in_box(0.0F, 4.0F);
      if (on_grid) p = glm::floor(p);
      b.grow(p);
    }
    if (random.below(4) == 0) {
      const auto axis = static_cast<int>(random.below(3));
      b.hi[axis] = b.lo[axis];
    }
    set.extents.push_back(b);
    set.cell.grow(b.lo);
    set.cell.grow(b.hi);
  }
  if (random.below(3) == 0) set.cell.hi += Vec3f(1.0F);  // empty space to cut off
  return set;
}

// By the book: counts from the extents, areas from the boxes, in long double.
long double cost_by_definition(const SmallSet& set, const BuildParams& params, int axis, float p,
                               bool planar_left, std::uint64_t& references) {
  std::uint64_t n_left = 0;
  std::uint64_t n_right = 0;
  for (const Bounds3f& b : set.extents) {
    if (b.lo[axis] == b.hi[axis] && b.lo[axis] == p) {
      (planar_left ? n_left : n_right) += 1;
      continue;
    }
    if (b.lo[axis] < p) ++n_left;
    if (b.hi[axis] > p) ++n_right;
  }
  const auto area = [](const Bounds3f& b) {
    const auto e = [&](int k) {
      return static_cast<long double>(b.hi[k]) - static_cast<long double>(b.lo[k]);
    };
    return 2.0L * (e(0) * e(1) + e(1) * e(2) + e(2) * e(0));
  };
  Bounds3f left = set.cell;
  Bounds3f right = set.cell;
  left.hi[axis] = right.lo[axis] = p;
  const long double whole = area(set.cell);
  long double cost = params.k_t + params.k_i * (area(left) / whole * static_cast<long double>(n_left) +
                                                area(right) / whole * static_cast<long double>(n_right));
  if (n_left == 0 || n_right == 0) cost *= params.empty_factor;
  references = n_left + n_right;
  return cost;
}

long double best_by_definition(const SmallSet& set, const BuildParams& params, int axis,
                               std::uint64_t budget) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const Bounds3f& b : set.extents) {
    for (const float p : {b.lo[axis], b.hi[axis]}) {
      if (!(p > set.cell.lo[axis] && p < set.cell.hi[axis])) continue;
      for (const bool planar_left : {true, false}) {
        std::uint64_t references = 0;
        const long double cost = cost_by_definition(set, params, axis, p, planar_left, references);
        if (references > set.extents.size() + budget) continue;
        best = std::min(best, cost);
      }
    }
  }
  return best;
}

TEST(GreedyOptimality, SweepEqualsBruteForceRecount) {
  TestRandom random(11);
  std::size_t planes = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const SmallSet set = random_set(random);
    BuildParams params;
    params.k_i = 0.25 + static_cast<double>(random.uniform());
    const std::uint64_t budget = random.below(3) == 0 ? random.below(4) : 1000;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<EventKey> events;
      for (std::uint32_t id = 0; id < set.extents.size(); ++id) {
        render::append_events(set.extents[id].lo[axis], set.extents[id].hi[axis], id, events);
      }
      std::sort(events.begin(), events.end());
      const auto n = static_cast<std::uint32_t>(set.extents.size());
      const auto found = render::sweep_axis(events, axis, {set.cell, n, budget}, params).best;
      const long double best = best_by_definition(set, params, axis, budget);
      if (found.axis < 0) {
        EXPECT_FALSE(best < std::numeric_limits<long double>::infinity());
        continue;
      }
      ++planes;
      EXPECT_NEAR(static_cast<double>(found.cost), static_cast<double>(best),
                  1e-12 * static_cast<double>(best));
      std::uint64_t references = 0;
      const long double own = cost_by_definition(set, params, axis, found.position,
                                                 found.planar_left, references);
      EXPECT_NEAR(found.cost, static_cast<double>(own), 1e-12 * found.cost);
      EXPECT_EQ(references, std::uint64_t{found.n_left} + found.n_right);
    }
  }
  EXPECT_GT(planes, 5000U);
}

// What the builder asks: bins and counts must find the very plane that three full sweeps find.
TEST(GreedyOptimality, SearchFindsThePlaneOfTheSweepBitForBit) {
  render::SerialTaskRunner runner;
  TestRandom random(12);
  std::size_t planes = 0, beyond_budget = 0;
  for (int trial = 0; trial < 1200; ++trial) {
    const SmallSet set = random_set(random, trial % 8 == 0 ? 3000U : 60U);
    BuildParams params;
    params.k_i = trial % 3 == 0 ? 0.25 : 0.05 + static_cast<double>(random.uniform());
    BuildContext context({}, params, runner);
    const auto n = static_cast<std::uint32_t>(set.extents.size());
    const std::uint64_t budget = random.below(3) == 0 ? random.below(4) : 100'000;
    const render::SweepInput input{set.cell, n, budget};
    const double leaf_cost = params.k_i * n;
    render::SweepResult expected;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<EventKey> events;
      for (const Bounds3f& b : set.extents) render::append_events(b.lo[axis], b.hi[axis], 0, events);
      std::sort(events.begin(), events.end());
      const auto found = render::sweep_axis(events, axis, input, params);
      if (found.best.cost < expected.best.cost) expected.best = found.best;
      expected.unaffordable = std::min(expected.unaffordable, found.unaffordable);
    }
    std::vector<render::Reference> references;
    for (const Bounds3f& b : set.extents) references.push_back(render::make_reference(b, 0));
    // In one piece and in three.
    const std::span<const render::Reference> all(references);
    const std::array<std::span<const render::Reference>, 3> pieces{
        all.first(n / 3), all.subspan(n / 3, n / 4), all.subspan(n / 3 + n / 4)};
    render::PlaneSearch search(context);
    for (const render::Runs runs : {render::Runs(&all, 1), render::Runs(pieces)}) {
      render::BuildStats counts;
      const auto found = search.find(runs, input, leaf_cost, runs.size() > 1, counts);
      const bool useful = expected.best.cost < leaf_cost;
      ASSERT_EQ(found.best.cost < leaf_cost, useful) << trial;
      const double bound = std::min(expected.best.cost, leaf_cost);
      EXPECT_EQ(found.unaffordable < std::min(found.best.cost, leaf_cost),
                expected.unaffordable < bound);
      beyond_budget += expected.unaffordable < bound ? 1U : 0U;
      if (!useful) continue;
      ++planes;
      EXPECT_EQ(found.best.axis, expected.best.axis) << trial;
      EXPECT_EQ(found.best.position, expected.best.position) << trial;
      EXPECT_EQ(found.best.planar_left, expected.best.planar_left) << trial;
      EXPECT_EQ(found.best.cost, expected.best.cost) << trial;
    }
  }
  EXPECT_GT(planes, 1000U);
  EXPECT_GT(beyond_budget, 50U);
}

// Every split lowers the expected cost, as long as empty space is not favoured beyond its cost.
TEST(GreedyOptimality, TreesAreNeverDearerThanOneLeaf) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const TestMesh mesh = soup(5 + seed * 7, seed, 2.0F);
    BuildParams params;
    params.empty_factor = 1.0;
    const auto tree = build(mesh, params);
    const double leaf = tree->params.k_i * static_cast<double>(mesh.triangles.size());
    EXPECT_LE(render::build_stats(*tree).sah_cost, leaf * (1.0 + 1e-12) + 1e-12);
  }
}

}  // namespace
}  // namespace raykiln::test
