// The builder's kernels give the same bits for every instruction set, and both parts of a split cell
// get the bounds that each would get alone.
#include <cstring>

#include "build_kernels.hpp"
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
    EXPECT_EQ(by_one.full_axes, by_other.full_axes);
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

TEST(PartsClip, AreThoseOfEachCellAlone) {
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
    Reference in_left{}, in_right{};
    const auto found = render::PartsClip(left, right, axis).run(corners, in_left, in_right);
    const auto alone_left = render::clipped_bounds(corners, left);
    const auto alone_right = render::clipped_bounds(corners, right);
    ASSERT_EQ(found.left, alone_left.has_value());
    ASSERT_EQ(found.right, alone_right.has_value());
    const auto expect_box = [](const Bounds3f& box, const Reference& r) {
      const Reference expected = render::make_reference(box, 0);
      EXPECT_EQ(r.lo, expected.lo);
      EXPECT_EQ(r.hi, expected.hi);
    };
    if (found.left) expect_box(*alone_left, in_left);
    if (found.right) expect_box(*alone_right, in_right);
    in_both += found.left && found.right ? 1U : 0U;
  }
  EXPECT_GT(in_both, 10'000U);
}

}  // namespace
}  // namespace raykiln::test
