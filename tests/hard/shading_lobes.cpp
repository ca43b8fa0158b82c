// S01, S03, S06, S07, S08: what Phong and diffuse lobes reflect, in both light models.
#include <gtest/gtest.h>

#include <limits>

#include "hard/support/lobes.hpp"
#include "hard/support/members.hpp"
#include "hard/support/report.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using support::at_degrees;
using support::bsdf_at;
using support::kPhysicalBsdf;
using support::kSeedBsdf;
using support::make_material;
using support::numbered;

struct TableRow {
  double exponent, degrees, light, eye, max;
};

// Table P, to 6 digits.
const std::vector<TableRow> kTable{
    {1, 0, 1.000000, 0.666667, 0.666667},     {1, 45, 0.853553, 0.712207, 0.634796},
    {1, 60, 0.750000, 0.811997, 0.593269},    {1, 80, 0.586824, 1.573854, 0.531650},
    {1, 85, 0.543578, 2.777384, 0.515848},    {1, 89, 0.508726, 12.494345, 0.503171},
    {10, 0, 1.000000, 0.916667, 0.916667},    {10, 45, 0.996564, 0.917013, 0.842183},
    {10, 60, 0.959068, 0.925349, 0.769528},   {10, 80, 0.714762, 1.203880, 0.605219},
    {10, 85, 0.611457, 1.801393, 0.553509},   {10, 89, 0.522564, 6.931063, 0.510761},
    {100, 0, 1.000000, 0.990196, 0.990196},   {100, 45, 1.000000, 0.990196, 0.955548},
    {100, 60, 1.000000, 0.990196, 0.926763},  {100, 80, 0.960300, 0.999231, 0.780633},
    {100, 85, 0.809324, 1.109007, 0.663501},  {100, 89, 0.569450, 2.787223, 0.534641}};

constexpr double kTableDigits = 1e-6;  ///< the table's last digit, as a bias

/// Largest |mean - truth| in standard errors, and how many were within R2.
class Checks {
 public:
  void add(const Samples& samples, double truth, double bias, const std::string& what) {
    EXPECT_EQ(within_four_sigma(samples, truth, bias), Verdict::kAccepted)
        << what << ": " << samples.mean << " against " << truth << " +- " << samples.standard_error();
    ++checks_;
    const double beyond = std::abs(samples.mean - truth) - bias;
    if (beyond > 0.0) worst_ = std::max(worst_, beyond / samples.standard_error());
  }
  void report(Row& row) const {
    row.measured("largest |z|", worst_);
    row.measured("checks", checks_);
  }

 private:
  double worst_ = 0.0;
  std::uint64_t checks_ = 0;
};

Material phong(double exponent) { return make_material(0.0F, 1.0F, 0.0F, exponent); }

class S01 : public testing::TestWithParam<bool> {};

TEST_P(S01, GrazingViewOfThePhongLobe) {
  const bool seed = GetParam();
  const BsdfModel model = seed ? kSeedBsdf : kPhysicalBsdf;
  Members members(101);
  Row row("S01", "Phong lobe in white surroundings, e 1, 10, 100 at 0 to 89 degrees, 1e6 samples; 24 members, e "
          "0.3 to 1000, 0 to 89.9 degrees" + members.note(),
          seed ? "furnace radiance of the table, column eye" : "column max; weights <= 1 + 4u", mode_name(model));
  Checks checks;
  double largest = 0.0;
  std::uint64_t bad = 0;
  const auto check = [&](double e, double degrees, double truth, double bias, std::uint64_t n) {
    const Weights w = weights(bsdf_at(phong(e), at_degrees(degrees), model), n);
    checks.add(w.x, truth, bias, shown(e) + " at " + shown(degrees));
    largest = std::max(largest, w.largest);
    bad += w.bad;
  };
  const Albedo column = seed ? Albedo::kEye : Albedo::kMax;
  for (const TableRow& r : kTable) {
    check(r.exponent, r.degrees, seed ? r.eye : r.max, kTableDigits, 1'000'000);
    const double quadrature = phong_albedo(column, r.exponent, r.degrees * kDegree);
    EXPECT_NEAR(quadrature, seed ? r.eye : r.max, 3e-5 * quadrature);
  }
  for (int i = 0; i < 24; ++i) {
    const double e = members.scale(0.3, 1000.0);
    const double degrees = 90.0 - members.scale(0.1, 90.0);
    const double truth = phong_albedo(column, e, degrees * kDegree);
    check(e, degrees, truth, 1e-4 * truth, 100'000);
  }
  checks.report(row);
  row.measured("largest weight", largest);
  // On the horizon itself: finite, whatever it is.
  for (const double e : {0.0, 1.0, 1e4, 1e10}) {
    bad += weights(bsdf_at(phong(e), at_degrees(90.0 - 1e-7), model), 100'000).bad;
  }
  row.measured("NaN or Inf", bad);
  EXPECT_EQ(bad, 0U);
  if (!seed) {
    EXPECT_LE(largest, 1.0 + 4.0 * kUnit);
  }
}
INSTANTIATE_TEST_SUITE_P(BothModels, S01, testing::Values(true, false),
                         [](const auto& p) { return p.param ? "Seed" : "Physical"; });

TEST(S03, ExponentZeroAndTheWrongSideOfTheLobe) {
  Row row("S03", "e 0 at 0, 30, 60 degrees, 1e6 samples; 1e6 pairs of directions with cos(alpha) <= 0, e 0, 0.5, 1, 3",
          "flux 1 - theta/180 (seed), quadrature (physical); lobe 0 where cos(alpha) <= 0", "both");
  Checks checks;
  for (const double degrees : {0.0, 30.0, 60.0}) {
    const double theta = degrees * kDegree;
    checks.add(flux_reflected(phong(0.0), kSeedBsdf, at_degrees(degrees), 1'000'000), 1.0 - degrees / 180.0,
               1e-6, "seed " + shown(degrees));
    checks.add(flux_reflected(phong(0.0), kPhysicalBsdf, at_degrees(degrees), 1'000'000),
               phong_albedo(Albedo::kMax, 0.0, theta), 3e-5, "physical " + shown(degrees));
  }
  checks.report(row);
  std::uint64_t lit = 0, behind = 0;
  const std::uint64_t pairs = trials(1'000'000, 10'000'000);
  for (std::uint64_t i = 0; behind < pairs; ++i) {
    const VertexKey key = numbered(i, 3);
    const Vec3f wi = sample_uniform_sphere(uniform(key, Dimension::kLightU), uniform(key, Dimension::kLightV));
    const Vec3f wo = sample_uniform_sphere(uniform(key, Dimension::kLensX), uniform(key, Dimension::kLensY));
    const Vec3d mirror(-wo.x, -wo.y, wo.z);
    if (wo.z * wi.z <= 0.0F || dot(mirror, Vec3d(wi)) > -1e-6) continue;
    ++behind;
    const double e = std::array{0.0, 0.5, 1.0, 3.0}[i % 4];
    const BsdfValue value = evaluate(bsdf_at(phong(e), wo, i % 8 < 4 ? kSeedBsdf : kPhysicalBsdf), wi);
    lit += value.f_cos.x == 0.0 && value.pdf == 0.0 ? 0U : 1U;
  }
  row.never("values behind the lobe", lit, behind);
  EXPECT_EQ(lit, 0U);
}

TEST(S06, MixtureWeightsThatDoNotSumToOne) {
  Members members(106);
  Row row("S06", "diffuse + specular 0.3+0.4, 1+0, 0+1, 0+0, 0.999999+1e-6, seen head on, e 10, 1e6 samples; a zero "
          "channel; 20 members with sums 0.1 to 1" + members.note(),
          "d + s (e+1)/(e+2); black without NaN", "both");
  Checks checks;
  std::uint64_t bad = 0;
  const auto check = [&](float d, float s, double e, std::uint64_t n) {
    const double truth = static_cast<double>(d) + static_cast<double>(s) * (e + 1.0) / (e + 2.0);
    for (const BsdfModel& model : {kSeedBsdf, kPhysicalBsdf}) {
      const Weights w = weights(bsdf_at(make_material(d, s, 0.0F, e), at_degrees(0.0), model), n);
      bad += w.bad;
      if (truth == 0.0) {
        EXPECT_EQ(w.largest, 0.0);
      } else {
        checks.add(w.x, truth, 1e-6, shown(truth));
      }
    }
  };
  for (const auto& [d, s] : {std::pair{0.3F, 0.4F}, {1.0F, 0.0F}, {0.0F, 1.0F}, {0.0F, 0.0F}, {0.999999F, 1e-6F}}) {
    check(d, s, 10.0, 1'000'000);
  }
  for (int i = 0; i < 20; ++i) {
    const double sum = members.between(0.1, 1.0), share = members.between(0.0, 1.0);
    check(static_cast<float>(sum * share), static_cast<float>(sum * (1.0 - share)), members.scale(0.5, 1e3), 100'000);
  }
  Material coloured = make_material(0.0F, 0.0F, 0.0F, 10.0);
  coloured.diffuse = {0.5F, 0.0F, 0.1F};
  coloured.specular = {0.1F, 0.0F, 0.7F};
  Samples blue;
  for (std::uint64_t i = 0; i < 200'000; ++i) {
    const BsdfSample sample = sample_bsdf(bsdf_at(coloured, at_degrees(0.0)), numbered(i));
    bad += sample.weight.y == 0.0 && std::isfinite(sample.weight.x) ? 0U : 1U;
    blue.add(sample.weight.z);
  }
  checks.add(blue, static_cast<double>(0.1F) + static_cast<double>(0.7F) * 11.0 / 12.0, 1e-6, "blue channel");
  checks.report(row);
  row.measured("NaN, or light in a black channel", bad);
  EXPECT_EQ(bad, 0U);
}

/// f(from, to): light arrives from `from` and leaves to `to`.
double value(const Material& material, const Vec3f& from, const Vec3f& to, const BsdfModel& model) {
  return evaluate(bsdf_at(material, to, model), from).f_cos.x / std::abs(static_cast<double>(from.z));
}

// What a relative error of 1e-5 can be asked of. cos(alpha) of two float directions and a float axis
// is known to 4u at best: 2u from each of two lengths that are not exactly 1 (f is a function of unit
// vectors, and which ones a pair of floats stands for is known no better), so cos^e(alpha) to
// 4 u e/cos(alpha) relative. That is below 1e-5 for cos(alpha) > 0.24 at e = 10, and without bound
// where the lobe ends. Hence 1e-5 + 4 u e/cos(alpha) for every pair in the lobe, however far out.
TEST(S07, ReciprocityWhereItMustHold) {
  Row row("S07", "1e5 pairs of directions: diffuse opaque and transparent, Phong e 1 and 10",
          "f(a, b) = f(b, a) to 1e-5 + 4 u e/cos(alpha) (what float directions define); the seed's lobe: ratio "
          "cos_a/cos_b; both 0 behind the lobe", "both");
  double diffuse = 0.0, physical = 0.0, seed = 0.0, wide = 0.0, share = 0.0;
  std::uint64_t pairs = 0, one_sided = 0;
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    const VertexKey key = numbered(i, 7);
    Vec3f a = sample_uniform_sphere(uniform(key, Dimension::kLightU), uniform(key, Dimension::kLightV));
    Vec3f b = sample_uniform_sphere(uniform(key, Dimension::kLensX), uniform(key, Dimension::kLensY));
    for (const float transparent : {0.0F, 1.0F}) {
      const Material m = make_material(0.8F, 0.0F, transparent, 1.0);
      for (const BsdfModel& model : {kSeedBsdf, kPhysicalBsdf}) {
        const double forth = value(m, a, b, model), back = value(m, b, a, model);
        if (forth != back) diffuse = std::max(diffuse, relative_error(forth, back));
      }
    }
    a.z = std::abs(a.z);
    b.z = std::abs(b.z);
    const double cosine = dot(Vec3d(-a.x, -a.y, a.z), Vec3d(b));
    const double e = i % 2 == 0 ? 1.0 : 10.0;
    const Material m = phong(e);
    const double forth = value(m, a, b, kPhysicalBsdf), back = value(m, b, a, kPhysicalBsdf);
    if (!(cosine > 4.0 * kUnit)) {
      one_sided += cosine < -4.0 * kUnit && (forth != 0.0 || back != 0.0) ? 1U : 0U;
      continue;
    }
    ++pairs;
    const double limit = 1e-5 + 4.0 * kUnit * e / cosine;
    const double ratio = static_cast<double>(a.z) / static_cast<double>(b.z);
    const double difference = relative_error(forth, back);
    const double from_ratio = relative_error(value(m, a, b, kSeedBsdf) / value(m, b, a, kSeedBsdf), ratio);
    physical = std::max(physical, difference / limit);
    seed = std::max(seed, from_ratio / limit);
    if (cosine > 0.24) wide = std::max({wide, difference, from_ratio});
    share += difference <= 1e-5 ? 1.0 : 0.0;
  }
  row.measured("largest deviation, diffuse", diffuse);
  row.measured("physical lobe, over the limit", physical);
  row.measured("the seed's from its ratio, over the limit", seed);
  row.measured("both where cos(alpha) > 0.24", wide);
  row.measured("share of pairs within 1e-5", share / static_cast<double>(pairs));
  row.measured("pairs in the lobe", pairs);
  row.never("behind it and not 0", one_sided, 100'000 - pairs);
  EXPECT_LE(diffuse, 1e-5);
  EXPECT_LE(physical, 1.0);
  EXPECT_LE(seed, 1.0);
  EXPECT_LE(wide, 1e-5);
  EXPECT_EQ(one_sided, 0U);
  EXPECT_GT(pairs, 30'000U);
}

TEST(S08, EnergyInTheLightSense) {
  Members members(108);
  Row row("S08", "light from 0 to 89 degrees on a lobe of e 1, 10, 100, 1e6 samples; 12 members" + members.note(),
          "flux of the table, never above 1: column light (seed), max (physical)", "both");
  Checks checks;
  const auto check = [&](double e, double degrees, double light, double max, double bias, std::uint64_t n) {
    checks.add(flux_reflected(phong(e), kSeedBsdf, at_degrees(degrees), n), light, bias * light,
               "seed " + shown(e) + " at " + shown(degrees));
    checks.add(flux_reflected(phong(e), kPhysicalBsdf, at_degrees(degrees), n), max, bias * max,
               "physical " + shown(e) + " at " + shown(degrees));
  };
  // Near grazing a float wi.z of 0.0175 carries a relative rounding of 2e-6.
  for (const TableRow& r : kTable) check(r.exponent, r.degrees, r.light, r.max, 5e-6, all_trials(1'000'000));
  for (int i = 0; i < 12; ++i) {
    const double e = members.scale(0.3, 300.0), degrees = members.between(0.0, 85.0);
    check(e, degrees, phong_albedo(Albedo::kLight, e, degrees * kDegree),
          phong_albedo(Albedo::kMax, e, degrees * kDegree), 2e-4, 100'000);
  }
  checks.report(row);
}

}  // namespace
}  // namespace raykiln::hard
