// S02, S04, S05: directions are found with the density that is claimed for them, at every exponent
// and for every random number.
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "hard/support/lobes.hpp"
#include "hard/support/members.hpp"
#include "hard/support/report.hpp"
#include "raykiln/math/frame.hpp"
#include "raykiln/sampling/discrete_distribution.hpp"
#include "support/statistics.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using support::at_degrees;
using support::bsdf_at;
using support::kPhysicalBsdf;
using support::kSeedBsdf;
using support::make_material;
using support::numbered;

Vec3f random_direction(std::uint64_t i, std::uint64_t seed) {
  const VertexKey key = numbered(i, seed);
  return sample_uniform_sphere(uniform(key, Dimension::kLightU), uniform(key, Dimension::kLightV));
}

/// -(e + 1) ln cos(alpha) of a direction about its axis, both as floats: Exp(1) for the lobe.
double depth_in_lobe(const Vec3f& axis, const Vec3f& w, double exponent) {
  return -(exponent + 1.0) * std::log1p(-one_minus_cos(axis, w));
}

TEST(S02, PhongExponentsFromZeroToAMillionMillion) {
  Row row("S02", "e 0, 0.5, 1, 10, 1e4, 1e6, 1e7, 1e8, 1e9, 1e10, 1e12 about random axes, 1e6 directions each; from 1e4 on "
          "also through the BSDF in both models",
          "-(e+1) ln cos is Exp(1): KS p > 1e-4 at 1e5, mean 4 sigma; E cos^e = (e+1)/(2e+1); no NaN", "both");
  double least_p = 1.0, worst_mean = 0.0, worst_power = 0.0;
  std::uint64_t bad = 0, lost = 0;
  const auto judge = [&](double e, auto direction) {
    std::vector<double> first;
    Samples depth, power;
    for (std::uint64_t i = 0, n = all_trials(1'000'000); i < n; ++i) {
      const auto [axis, w, value] = direction(i);
      if (value < 0.0) {
        ++lost;
        continue;
      }
      const double v = depth_in_lobe(axis, w, e);
      bad += std::isfinite(v) && std::isfinite(value) ? 0U : 1U;
      depth.add(v);
      power.add(value);
      if (first.size() < 100'000) first.push_back(v);
    }
    const double p = support::kolmogorov_smirnov_p(first, [](double t) { return -std::expm1(-t); });
    EXPECT_GT(p, 1e-4) << e;
    least_p = std::min(least_p, p);
    // A float direction is off its axis' circle by 2^-24: 1 - cos by up to its square besides noise.
    const double rounding = (e + 1.0) * 3.0 * 0x1p-48;
    EXPECT_EQ(within_four_sigma(depth, 1.0, rounding), Verdict::kAccepted) << e << ' ' << depth.mean;
    const double truth = (e + 1.0) / (2.0 * e + 1.0);
    EXPECT_EQ(within_four_sigma(power, truth, rounding), Verdict::kAccepted) << e << ' ' << power.mean;
    worst_mean = std::max(worst_mean, std::abs(depth.mean - 1.0) / depth.standard_error());
    if (power.standard_error() > 0.0) {
      worst_power = std::max(worst_power, std::abs(power.mean - truth) / power.standard_error());
    }
  };
  struct Found {
    Vec3f axis, w;
    double power;  ///< cos^e as evaluated from the float direction; negative: no direction
  };
  for (const double e : {0.0, 0.5, 1.0, 10.0, 1e4, 1e6, 1e7, 1e8, 1e9, 1e10, 1e12}) {
    judge(e, [&](std::uint64_t i) {
      const VertexKey key = numbered(i, 2);
      const Vec3f axis = random_direction(i, 5);
      const Vec3f w = around_axis(axis, sample_one_minus_cos(uniform(key, Dimension::kDirectionU), e),
                                  uniform(key, Dimension::kDirectionV));
      return Found{axis, w, cosine_power_pdf(one_minus_cos(axis, w), e) * 2.0 * kPi / (e + 1.0)};
    });
    if (e < 1e4) continue;  // part of a broad lobe lies below the horizon
    for (const BsdfModel& model : {kSeedBsdf, kPhysicalBsdf}) {
      judge(e, [&](std::uint64_t i) {
        const Bsdf bsdf = bsdf_at(make_material(0.0F, 1.0F, 0.0F, e), at_degrees(70.0 * static_cast<double>(i % 97) / 97.0), model);
        const BsdfSample s = sample_bsdf(bsdf, numbered(i, 4));
        if (s.lobe == Lobe::kNone) return Found{{}, {}, -1.0};
        bad += s.weight.x > 0.0 && s.weight.x < 2.0 ? 0U : 1U;
        return Found{bsdf.mirror, s.wi, cosine_power_pdf(one_minus_cos(bsdf.mirror, s.wi), e) * 2.0 * kPi / (e + 1.0)};
      });
    }
  }
  row.measured("least p", least_p);
  row.measured("largest |z| of the mean", worst_mean);
  row.measured("of E cos^e", worst_power);
  row.measured("NaN, or weights outside (0, 2)", bad);
  row.measured("directions lost", lost);
  EXPECT_EQ(bad, 0U);
  EXPECT_EQ(lost, 0U);
}

TEST(S04, ExtremesOfTheRandomNumber) {
  Row row("S04", "u, v, choices from {0, 2^-53, 2^-32, 0.5, 1-2^-24, 1-2^-53} in every combination, all warps, 11 materials, "
          "6 exponents, 9 angles", "finite weight, density and unit direction; no number is 1", "both");
  const std::array<double, 6> extremes{0.0, 0x1p-53, 0x1p-32, 0.5, 1.0 - 0x1p-24, 1.0 - 0x1p-53};
  std::uint64_t bad = 0, tried = 0;
  const auto unit = [](const Vec3f& w) { return std::abs(length(w) - 1.0F) < 1e-5F; };
  const auto materials = [] {
    std::vector<Material> list;
    for (const auto& [name, m] : support::lobe_materials()) list.push_back(m);
    for (const double e : {0.0, 1.0, 1e4, 1e8, 1e12, 1e300}) {
      for (const float t : {0.0F, 0.5F, 1.0F}) list.push_back(make_material(0.3F, 0.6F, t, e));
    }
    return list;
  }();
  for (const double u : extremes) {
    for (const double v : extremes) {
      bad += unit(sample_uniform_sphere(u, v)) ? 0U : 1U;
      const TrianglePoint b = sample_uniform_triangle(u, v);
      bad += b.b1 >= 0.0 && b.b2 >= 0.0 && b.b1 + b.b2 <= 1.0 ? 0U : 1U;
      const std::array<double, 4> powers{0.0, 3.0, 0.0, 1e-300};
      bad += DiscreteDistribution(powers).sample(u) % 2 == 1 ? 0U : 1U;
      tried += 3;
      for (const double e : {0.0, 0.5, 1.0, 1e4, 1e10, 1e15}) {
        const double x = sample_one_minus_cos(u, e);
        bad += x >= 0.0 && x < 1.0 && unit(around_axis(at_degrees(40.0), x, v)) ? 0U : 1U;
        ++tried;
      }
      const double c = sample_cosine_one_minus_cos(u);
      bad += c >= 0.0 && c < 1.0 ? 0U : 1U;
      for (const Material& m : materials) {
        for (const double degrees : {0.0, 41.8, 60.0, 89.9999, 90.0, 90.0001, 120.0, 138.2, 180.0}) {
          for (const BsdfModel& model : {kSeedBsdf, kPhysicalBsdf}) {
            const Bsdf bsdf = bsdf_at(m, at_degrees(degrees), model);
            for (const double lobe : {0.0, 1.0 - 0x1p-53}) {
              for (const double side : {0.0, 1.0 - 0x1p-53}) {
                const BsdfSample s = sample_bsdf(bsdf, DirectionNumbers{lobe, side, u, v});
                ++tried;
                if (s.lobe == Lobe::kNone) continue;
                bad += std::isfinite(s.weight.x) && s.weight.x >= 0.0 && std::isfinite(s.pdf) && s.pdf > 0.0 && unit(s.wi) ? 0U : 1U;
              }
            }
          }
        }
      }
    }
  }
  row.never("not finite, not unit, out of range", bad, tried);
  EXPECT_EQ(bad, 0U);
  // The largest number that 64 random bits can become.
  EXPECT_LT(static_cast<double>(~std::uint64_t{0} >> 11) * 0x1p-53, 1.0);
}

// ---- S05 ----

/// Cells of a chi-square test, the last one for samples that found no direction.
struct Cells {
  std::vector<double> seen, expected;
};

/// A sanitizer is after the code's faults, not the distribution's.
constexpr std::uint64_t kSamples = tests::kSanitized ? 62'500 : 1'000'000;

/// The azimuth of the directions of view in these tests: lobes are symmetric about it.
const Vec3d kAlong(0.8, -0.6, 0.0), kAcross(0.6, 0.8, 0.0);

/// On the sphere, in cells of equal solid angle, azimuths from that of the view; the density by a
/// midpoint rule within each, over one half of the sphere for both, fine across the rings, where it
/// ends at the critical angle.
Cells cells_on_the_sphere(const Bsdf& bsdf, double claimed) {
  constexpr int kRings = 48, kSectors = 64, kInnerRings = 160, kInnerSectors = 4;
  Cells cells{std::vector<double>(kRings * kSectors + 1), std::vector<double>(kRings * kSectors + 1)};
  const auto cell_of = [](const Vec3f& w) {
    const double phi = std::atan2(dot(Vec3d(w), kAcross), dot(Vec3d(w), kAlong));
    const int ring = std::clamp(static_cast<int>((static_cast<double>(w.z) + 1.0) * 0.5 * kRings), 0, kRings - 1);
    const int sector = std::clamp(static_cast<int>((phi / (2.0 * kPi) + 0.5) * kSectors), 0, kSectors - 1);
    return static_cast<std::size_t>(ring * kSectors + sector);
  };
  const double area = 4.0 * kPi / (kRings * kInnerRings * kSectors * kInnerSectors);
  double total = 0.0;
  for (int i = 0; i < kRings * kInnerRings; ++i) {
    const double z = -1.0 + 2.0 * (i + 0.5) / (kRings * kInnerRings), s = std::sqrt(1.0 - z * z);
    for (int j = 0; j < kSectors * kInnerSectors / 2; ++j) {
      const double phi = 2.0 * kPi * (j + 0.5) / (kSectors * kInnerSectors);
      const Vec3d in_plane = s * std::cos(phi) * kAlong + Vec3d(0.0, 0.0, z), side = s * std::sin(phi) * kAcross;
      const Vec3f w(in_plane + side);
      const BsdfValue value = evaluate(bsdf, w);
      if (value.f_cos == Rgbd(0.0)) continue;
      const double expected = claimed * value.pdf * area * static_cast<double>(kSamples);
      cells.expected[cell_of(w)] += expected;
      cells.expected[cell_of(Vec3f(in_plane - side))] += expected;
      total += 2.0 * expected;
    }
  }
  cells.expected.back() = std::max(0.0, static_cast<double>(kSamples) - total);
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const BsdfSample s = sample_bsdf(bsdf, numbered(i, 9));
    cells.seen[s.lobe == Lobe::kNone ? cells.seen.size() - 1 : cell_of(s.wi)] += 1.0;
  }
  return cells;
}

/// About the axis of a sharp lobe, in (probability depth, azimuth), where the lobe alone is uniform.
/// `through` chooses the refracted lobe. Directions outside of the lobe's side share the last cell.
Cells cells_about_the_axis(const Bsdf& bsdf, bool through) {
  constexpr int kDepths = 32, kTurns = 32;
  Cells cells{std::vector<double>(kDepths * kTurns + 1), std::vector<double>(kDepths * kTurns + 1)};
  const Vec3f axis = through ? bsdf.refracted : bsdf.mirror;
  const double e = bsdf.exponent;
  double total = 0.0;
  // Away from the horizon the density is a constant times the lobe's own. Where the horizon cuts the
  // lobe, at grazing views through its axis, the rule must be fine in the turn.
  const bool cut = std::abs(static_cast<double>(dot(bsdf.ng, axis))) < 10.0 / std::sqrt(e);
  const int inner = cut ? 16 : 2, inner_turns = cut ? 128 : 4;
  for (int i = 0; i < kDepths * inner; ++i) {
    const double x = sample_one_minus_cos((i + 0.5) / (kDepths * inner), e);
    for (int j = 0; j < kTurns * inner_turns; ++j) {
      const Vec3f w = around_axis(axis, x, (j + 0.5) / (kTurns * inner_turns));
      const BsdfValue value = evaluate(bsdf, w);
      const bool other_side = dot(bsdf.ng, w) < 0.0F;
      if (value.f_cos == Rgbd(0.0) || other_side != through) continue;
      const double share = value.pdf / cosine_power_pdf(one_minus_cos(axis, w), e);
      const double expected = share * static_cast<double>(kSamples) / (kDepths * kTurns * inner * inner_turns);
      cells.expected[static_cast<std::size_t>((i / inner) * kTurns + j / inner_turns)] += expected;
      total += expected;
    }
  }
  cells.expected.back() = std::max(0.0, static_cast<double>(kSamples) - total);
  const Frame frame(axis);
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const BsdfSample s = sample_bsdf(bsdf, numbered(i, 9));
    std::size_t cell = cells.seen.size() - 1;
    if (s.lobe != Lobe::kNone && (dot(bsdf.ng, s.wi) < 0.0F) == through) {
      const double depth = -std::expm1(-depth_in_lobe(axis, s.wi, e));
      const Vec3d w(s.wi);
      double turn = std::atan2(dot(w, Vec3d(frame.t)), dot(w, Vec3d(frame.s))) / (2.0 * kPi);
      if (turn < 0.0) turn += 1.0;
      cell = static_cast<std::size_t>(std::min(static_cast<int>(depth * kDepths), kDepths - 1) * kTurns +
                                      std::min(static_cast<int>(turn * kTurns), kTurns - 1));
    }
    cells.seen[cell] += 1.0;
  }
  return cells;
}

struct LobeCase {
  std::string name;
  Material material;
  bool about_axis = false, through = false;
};

const std::vector<LobeCase> kLobes{
    {"diffuse opaque", make_material(0.8F, 0, 0, 1)},
    {"diffuse transparent", make_material(0.8F, 0, 1, 1)},
    {"phong 1", make_material(0, 1, 0, 1)},
    {"phong 10", make_material(0, 1, 0, 10)},
    {"phong 1e3", make_material(0, 1, 0, 1e3), true, false},
    {"phong 1e6", make_material(0, 1, 0, 1e6), true, false},
    {"refraction 1.5, e 30", make_material(0, 1, 1, 30, 1.5F)},
    {"refraction 1/1.5, e 30", make_material(0, 1, 1, 30, 1.0F / 1.5F)},
    {"refraction 1.5, e 1e5", make_material(0, 1, 1, 1e5, 1.5F), true, true},
    {"refraction 1/1.5, e 1e5", make_material(0, 1, 1, 1e5, 1.0F / 1.5F), true, true},
    {"four parts", make_material(0.3F, 0.4F, 0.5F, 30)}};

class S05 : public testing::TestWithParam<bool> {};

TEST_P(S05, SamplingAndDensityAgree) {
  const BsdfModel model = GetParam() ? kSeedBsdf : kPhysicalBsdf;
  Row row("S05", "11 lobes and mixtures at 10 angles incl. 85 and 89.9 degrees and from behind, 1e6 samples each; sharp "
          "lobes in (depth, azimuth)", "chi-square at 0.01 (Sidak); lost samples expected too; a density short of a mixture weight is refused", mode_name(model));
  const std::array<double, 10> angles{0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.9, 120.0, 170.0};
  const double level = support::sidak_level(static_cast<double>(kLobes.size() * angles.size()));
  double least = 1.0;
  std::uint64_t tests = 0;
  for (const LobeCase& lobe : kLobes) {
    for (std::size_t i = 0; i < angles.size(); i += tests::kSanitized ? 3 : 1) {
      const double degrees = angles[i];
      const Bsdf bsdf = bsdf_at(lobe.material, at_degrees(degrees), model);
      if (lobe.through && bsdf.cos_t == 0.0) continue;  // total reflection
      const Cells cells = lobe.about_axis ? cells_about_the_axis(bsdf, lobe.through) : cells_on_the_sphere(bsdf, 1.0);
      const double p = support::chi_square_p(cells.seen, cells.expected);
      EXPECT_GT(p, level) << lobe.name << " at " << degrees;
      least = std::min(least, p);
      ++tests;
    }
  }
  row.measured("least p", least);
  row.measured("level", level);
  row.measured("tests", tests);
  const Cells planted = cells_on_the_sphere(bsdf_at(kLobes.back().material, at_degrees(30.0), model), 0.7);
  EXPECT_LT(support::chi_square_p(planted.seen, planted.expected), 1e-6);
}
INSTANTIATE_TEST_SUITE_P(BothModels, S05, testing::Values(true, false),
                         [](const auto& p) { return p.param ? "Seed" : "Physical"; });

}  // namespace
}  // namespace raykiln::hard
