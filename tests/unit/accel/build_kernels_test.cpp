// The builder's kernels give the same bits for every instruction set, and both parts of a split cell
// get the bounds that each would get alone.
#include <cstring>

#include "build_kernels.hpp"
#include "bin_search.hpp"
#include "cell_bins.hpp"
#include "polygon_clip.hpp"
#include "sah_sweep.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::BinCode;
using render::Bounds3f;
using render::Reference;

struct RandomCell {
  Bounds3f box;
  std::vector<Reference> references;
};

// Some on a grid, some flat, some wider than floats or nearly without area.
RandomCell random_cell(TestRandom& random, std::uint32_t most) {
  const bool on_grid = random.below(2) == 0;
  const float scale = std::array{1.0F, 1.0F, 1.0F, 0x1p125F, 0x1p-120F}[random.below(5)];
  const auto corner = [&] {
    const Vec3f p = random.in_box(-1.0F, 1.0F) * 4.0F;
    return (on_grid ? glm::floor(p) : p) * scale;
  };
  RandomCell cell;
  cell.references.resize(1 + random.below(most));
  const auto flat = static_cast<int>(random.below(12));
  for (std::size_t i = 0; i < cell.references.size(); ++i) {
    Bounds3f box;
    box.grow(corner());
    box.grow(corner());
    if (flat < 3) box.lo[flat] = box.hi[flat] = scale;
    if (random.below(4) == 0) box.hi[1] = box.lo[1];
    cell.references[i] = render::make_reference(box, static_cast<std::uint32_t>(3 * i));
    cell.box.grow(box.lo);
    cell.box.grow(box.hi);
  }
  if (random.below(3) == 0) cell.box.hi += Vec3f(scale);
  return cell;
}

class BuildKernelsAgree : public ::testing::Test {
 protected:
  void SetUp() override {
    if (other_ == nullptr) GTEST_SKIP() << "this processor has one kind of kernel only";
  }
  const render::BuildKernels& one_ = render::kAnyBuildKernels;
  const render::BuildKernels* other_ = render::avx2_build_kernels();
};

TEST_F(BuildKernelsAgree, OnThePlanesOfSmallCells) {
  TestRandom random(71);
  std::size_t planes = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const RandomCell cell = random_cell(random, render::kCountingMax);
    const auto n = static_cast<std::uint32_t>(cell.references.size());
    render::CountingQuery q{};
    q.references = render::words_of(cell.references.data());
    q.n = n;
    q.affordable = static_cast<std::int32_t>(n + random.below(n + 1));
    const auto costs = render::rough_costs(cell.box, {});
    q.leaf = 0.25F * static_cast<float>(n);
    for (int axis = 0; axis < 3; ++axis) {
      q.cell_lo[axis] = cell.box.lo[axis];
      q.cell_hi[axis] = cell.box.hi[axis];
      q.per_width[axis] = 1.0F / (cell.box.hi[axis] - cell.box.lo[axis]);
      q.cost[axis] = costs[static_cast<std::size_t>(axis)];
    }
    std::array<render::CountedPlane, render::kMostCountedPlanes> a{}, b{};
    render::CountedPlanes by_one{a.data(), 0, 0}, by_other{b.data(), 0, 0};
    one_.count_planes(q, by_one);
    other_->count_planes(q, by_other);
    ASSERT_EQ(by_one.size, by_other.size);
    EXPECT_EQ(by_one.operations, by_other.operations);
    EXPECT_EQ(std::memcmp(a.data(), b.data(), by_one.size * sizeof(a[0])), 0);
    planes += by_one.size;
  }
  EXPECT_GT(planes, 4000U);
}

TEST_F(BuildKernelsAgree, OnBinsBoundsAndWhatIsFound) {
  TestRandom random(72);
  for (int trial = 0; trial < 600; ++trial) {
    const RandomCell cell = random_cell(random, 700);
    const auto n = static_cast<std::uint32_t>(cell.references.size());
    const std::size_t bins = std::array<std::size_t, 4>{16, 32, 64, render::kMaxBins}[random.below(4)];
    const render::BinGrid grid(cell.box, bins);
    std::vector<BinCode> codes(n), same(n);
    render::BinCounts counts{}, others{};
    counts.clear(bins);
    others.clear(bins);
    counts.count(one_, grid, cell.references, codes.data());
    others.count(*other_, grid, cell.references, same.data());
    EXPECT_EQ(codes, same);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < bins + 2; ++b) {
        ASSERT_EQ(counts.starts(a)[b], others.starts(a)[b]);
        ASSERT_EQ(counts.ends(a)[b], others.ends(a)[b]);
      }
    }
    render::WantedBins wanted;
    for (std::uint32_t i = random.below(5) + 1; i > 0; --i) {
      wanted.add(random.below(3), 1 + random.below(static_cast<std::uint32_t>(bins)));
    }
    std::vector<std::uint16_t> found(n + 4), found_too(n + 4), expected;
    found.resize(one_.find_codes(codes.data(), n, wanted.first, wanted.span, wanted.axes, found.data()));
    found_too.resize(
        other_->find_codes(codes.data(), n, wanted.first, wanted.span, wanted.axes, found_too.data()));
    for (std::uint16_t i = 0; i < n; ++i) {
      bool in = false;
      for (unsigned shift = 0; shift < 64; shift += 8) {
        const auto bin = static_cast<std::uint8_t>((codes[i] >> shift) - (wanted.first >> shift));
        in |= (wanted.axes >> shift & 0xFF) != 0 && bin <= (wanted.span >> shift & 0xFF);
      }
      if (in) expected.push_back(i);
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found_too, expected);
    for (std::size_t a = 0; a < 3; ++a) {
      const render::BinBoundsQuery query{
          counts.starts(a), counts.ends(a), bins, n, static_cast<std::int32_t>(random.below(n + 1)),
          render::rough_costs(cell.box, {})[a], grid.edges_known(a)};
      render::BinBounds bounds{}, others_bounds{};
      EXPECT_EQ(one_.bound_bins(query, bounds), other_->bound_bins(query, others_bounds));
      EXPECT_EQ(std::memcmp(&bounds, &others_bounds, sizeof bounds), 0);
    }
  }
}

// Of the planes at all sorted events the search must find what the sweep finds, ties and the cheapest
// beyond the budget included, whatever it passes over.
TEST(BinSearch, FindsWhatASweepOverAllEventsFinds) {
  TestRandom random(74);
  std::size_t splits = 0, beyond = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const RandomCell cell = random_cell(random, std::array{30U, 200U, 900U}[random.below(3)]);
    const auto n = static_cast<std::uint32_t>(cell.references.size());
    const render::SweepInput input{cell.box, n, random.below(3) == 0 ? random.below(n) : n};
    const render::BuildParams params;
    render::SerialTaskRunner runner;
    const render::TriangleView mesh{};
    render::BuildContext context(mesh, params, runner);
    const int axis = static_cast<int>(random.below(3));
    std::vector<render::EventKey> events;
    for (const Reference& r : cell.references) {
      const auto k = static_cast<std::size_t>(axis);
      render::append_events(r.lo[k], r.hi[k], 0, events);
    }
    std::vector<render::EventKey> sorted = events;
    std::sort(sorted.begin(), sorted.end());
    const render::SweepResult expected = render::sweep_axis(sorted, axis, input, params);
    const double leaf = params.k_i * n;
    render::PlaneChooser chooser(axis, input, params);
    render::BuildStats counts;
    const auto rough = render::rough_costs(cell.box, params)[static_cast<std::size_t>(axis)];
    render::BinSearch(context).run(events, input, 0, 0, rough, {leaf, std::numeric_limits<double>::infinity()}, chooser, counts);
    const render::SweepResult& found = chooser.result();
    if (expected.best.cost < leaf) {
      ++splits;
      EXPECT_EQ(found.best.cost, expected.best.cost);
      EXPECT_EQ(found.best.position, expected.best.position);
      EXPECT_EQ(found.best.planar_left, expected.best.planar_left);
    } else {
      EXPECT_FALSE(found.best.cost < leaf);
    }
    if (expected.unaffordable < std::min(leaf, expected.best.cost)) {
      ++beyond;
      EXPECT_LT(found.unaffordable, std::min(leaf, expected.best.cost));
    } else {
      EXPECT_FALSE(found.unaffordable < std::min(leaf, expected.best.cost));
    }
  }
  EXPECT_GT(splits, 300U);
  EXPECT_GT(beyond, 30U);
}

TEST_F(BuildKernelsAgree, OnTheSidesOfReferences) {
  TestRandom random(75);
  for (int trial = 0; trial < 2000; ++trial) {
    const RandomCell cell = random_cell(random, render::kSplitBlock);
    const std::size_t n = cell.references.size();
    const Reference& some = cell.references[random.below(static_cast<std::uint32_t>(n))];
    const std::uint32_t axis = random.below(3);
    const float at = std::array{some.lo[axis], some.hi[axis], 0.0F, random.uniform(-4.0F, 4.0F)}[random.below(4)];
    const render::SplitQuery query{at, axis, random.below(2)};
    std::vector<Reference> left(n + 1), right(n + 1), left_too(n + 1), right_too(n + 1);
    render::SplitCounts counts{}, same{};
    const auto* from = render::words_of(cell.references.data());
    one_.split_references(query, from, static_cast<std::uint32_t>(n), render::words_of(left.data()),
                          render::words_of(right.data()), counts);
    other_->split_references(query, from, static_cast<std::uint32_t>(n), render::words_of(left_too.data()),
                             render::words_of(right_too.data()), same);
    ASSERT_EQ(counts.left, same.left);
    ASSERT_EQ(counts.right, same.right);
    ASSERT_EQ(counts.n_both, same.n_both);
    EXPECT_EQ(std::memcmp(counts.both, same.both, counts.n_both * sizeof(counts.both[0])), 0);
    EXPECT_EQ(std::memcmp(left.data(), left_too.data(), counts.left * sizeof(Reference)), 0);
    EXPECT_EQ(std::memcmp(right.data(), right_too.data(), counts.right * sizeof(Reference)), 0);
    std::size_t expected_left = 0, expected_both = 0;
    for (const Reference& r : cell.references) {
      const bool before = r.lo[axis] < at, behind = r.hi[axis] > at;
      expected_left += before || (!behind && query.planar_left != 0) ? 1U : 0U;
      expected_both += before && behind ? 1U : 0U;
    }
    EXPECT_EQ(counts.left, expected_left);
    EXPECT_EQ(counts.n_both, expected_both);
  }
}

TEST(ClippedParts, AreThoseOfEachCellAlone) {
  TestRandom random(73);
  std::uint32_t in_both = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const float spread = std::array{0.5F, 1.0F, 4.0F}[random.below(3)];
    std::array<Vec3f, 3> corners;
    for (Vec3f& p : corners) p = random.in_box(-spread, spread);
    if (random.below(4) == 0) {
      for (Vec3f& p : corners) p = glm::round(p * 4.0F) / 4.0F;
    }
    Bounds3f cell;
    cell.grow(random.in_box(-1.0F, 1.0F));
    cell.grow(random.in_box(-1.0F, 1.0F));
    const auto axis = static_cast<int>(random.below(3));
    float plane = random.uniform(cell.lo[axis], cell.hi[axis]);
    if (random.below(3) == 0) {  // the triangle in the cell, but for a corner or two at the plane
      cell = {};
      for (Vec3f& p : corners) {
        if (random.below(2) == 0) p[axis] *= 1e-17F;
        cell.grow(p);
      }
      plane = corners[random.below(3)][axis] * (random.below(2) == 0 ? 1.0F : 1.001F);
      if (!(cell.lo[axis] < plane && plane < cell.hi[axis])) continue;
    }
    Bounds3f left = cell;
    Bounds3f right = cell;
    left.hi[axis] = right.lo[axis] = plane;
    std::array<float, 9> words;
    for (std::size_t c = 0; c < 9; ++c) words[c] = corners[c / 3][static_cast<int>(c % 3)];
    const std::array<std::uint32_t, 3> triangle{0, 1, 2};
    render::ClipQuery query{words.data(), triangle.data(), {}, {}, static_cast<std::uint32_t>(axis)};
    for (int k = 0; k < 3; ++k) {
      query.left[0][k] = left.lo[k];
      query.left[1][k] = left.hi[k];
      query.right[0][k] = right.lo[k];
      query.right[1][k] = right.hi[k];
    }
    const auto alone_left = render::clipped_bounds(corners, left);
    const auto alone_right = render::clipped_bounds(corners, right);
    const auto expect_box = [](const Bounds3f& box, const Reference& r) {
      const Reference expected = render::make_reference(box, 0);
      EXPECT_EQ(r.lo, expected.lo);
      EXPECT_EQ(r.hi, expected.hi);
    };
    for (const render::BuildKernels* kernels : {&render::kAnyBuildKernels, render::avx2_build_kernels()}) {
      if (kernels == nullptr) continue;
      Reference in_left{}, in_right{};
      const render::SplitCounts::Both place{0, 0};
      const unsigned found = kernels->clip_references(query, &place, 1, render::words_of(&in_left),
                                                      render::words_of(&in_right));
      ASSERT_EQ((found & 1U) != 0, alone_left.has_value());
      ASSERT_EQ((found & 2U) != 0, alone_right.has_value());
      EXPECT_EQ(in_left.triangle, alone_left ? 0U : render::kNoReference);
      EXPECT_EQ(in_right.triangle, alone_right ? 0U : render::kNoReference);
      if (alone_left) expect_box(*alone_left, in_left);
      if (alone_right) expect_box(*alone_right, in_right);
    }
    in_both += alone_left && alone_right ? 1U : 0U;
  }
  EXPECT_GT(in_both, 10'000U);
}

}  // namespace
}  // namespace raykiln::test
