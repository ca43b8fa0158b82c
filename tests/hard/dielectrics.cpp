// D01-D05: borders between media, by formula and in pictures.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "hard/support/hard_meshes.hpp"
#include "hard/support/lobes.hpp"
#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/pictures.hpp"
#include "hard/support/report.hpp"
#include "raykiln/selftest/measure.hpp"
#include "raykiln/selftest/small_scene.hpp"
#include "raykiln/shading/fresnel.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using render::selftest::clear_glass;
using render::selftest::matte;
using render::selftest::measure;
using render::selftest::Measured;
using render::selftest::SmallScene;

TEST(D01, ExactlyAtTheCriticalAngle) {
  Members members(401);
  Row row("D01", "n 1.5 and 400 members 1.02 to 3, from inside, cosines at the critical angle and 8 doubles and 8 floats to either side; "
          "the same as directions of view" + members.note(),
          "F continuous: within 1e-6 of 80-bit arithmetic, >= 0.9965 for the doubles; refracted direction unit or none; no NaN", "both");
  std::uint64_t bad = 0, tried = 0;
  double worst = 0.0, least = 1.0;
  const auto check = [&](double cosine, double n, bool is_double) {
    for (const FresnelFormula formula : {FresnelFormula::kExact, FresnelFormula::kSchlick}) {
      const FresnelTerm term = fresnel(formula, cosine, n, 1.0);
      ++tried;
      bad += std::isfinite(term.reflectance) && std::isfinite(term.cos_t) ? 0U : 1U;
      bad += term.total_reflection == (term.cos_t == 0.0) ? 0U : 1U;
      const long double c = cosine, m = n, cos2 = 1.0L - m * m * (1.0L - c) * (1.0L + c);
      const long double t = cos2 > 0.0L ? std::sqrt(cos2) : 0.0L;
      const long double rs = (m * c - t) / (m * c + t), rp = (c - m * t) / (c + m * t);
      const long double r0 = (m - 1.0L) * (m - 1.0L) / ((m + 1.0L) * (m + 1.0L));
      const auto truth = static_cast<double>(formula == FresnelFormula::kExact
                                                 ? 0.5L * (rs * rs + rp * rp)
                                                 : r0 + (1.0L - r0) * std::pow(1.0L - t, 5.0L));
      worst = std::max(worst, std::abs(term.reflectance - truth));
      if (is_double) least = std::min(least, term.reflectance);
    }
    // The same through a direction of view: whatever rounding the floats bring.
    const auto cos_view = static_cast<float>(cosine);
    const auto sine = static_cast<float>(std::sqrt((1.0 - cosine) * (1.0 + cosine)));
    const Material glass = support::make_material(0, 1, 1, 1e10, static_cast<float>(n));
    for (const BsdfModel& model : {support::kPhysicalBsdf, support::kSeedBsdf}) {
      const Bsdf bsdf = support::bsdf_at(glass, {0.6F * sine, 0.8F * sine, -cos_view}, model);
      const double length2 = dot(Vec3d(bsdf.refracted), Vec3d(bsdf.refracted));
      ++tried;
      bad += bsdf.cos_t == 0.0 || std::abs(std::sqrt(length2) - 1.0) <= 1e-6 ? 0U : 1U;
      for (std::uint64_t i = 0; i < 20; ++i) {
        bad += std::isfinite(sample_bsdf(bsdf, support::numbered(i)).weight.x) ? 0U : 1U;
      }
    }
  };
  for (int member = 0; member <= 400; ++member) {
    const double n = member == 0 ? 1.5 : members.between(1.02, 3.0);
    const double critical = std::sqrt((1.0 - 1.0 / n) * (1.0 + 1.0 / n));
    double d = critical;
    auto f = static_cast<float>(critical);
    for (int i = 0; i < 8; ++i) d = std::nextafter(d, 0.0), f = std::nextafterf(f, 0.0F);
    for (int i = 0; i < 17; ++i) {
      check(d, n, true);
      check(static_cast<double>(f), n, false);
      d = std::nextafter(d, 1.0);
      f = std::nextafterf(f, 1.0F);
    }
    // sin^2 of the refracted ray 1 - u, 1, 1 + u.
    for (const double sin2 : {1.0 - kUnit, 1.0, 1.0 + kUnit}) check(std::sqrt(1.0 - sin2 / (n * n)), n, false);
  }
  // Near the angle 1 - F = 2 (n + 1/n)/cos(critical) cos_t: 5.814 cos_t for n = 1.5.
  EXPECT_NEAR(2.0 * (1.5 + 1.0 / 1.5) / std::sqrt(1.0 - 1.0 / 2.25), 5.814, 5e-4);
  double slope = 0.0;
  for (int member = 0; member < 400; ++member) {
    const double n = members.between(1.02, 3.0), critical = std::sqrt((1.0 - 1.0 / n) * (1.0 + 1.0 / n));
    const FresnelTerm near = fresnel_exact(critical * (1.0 + 1e-9), n, 1.0);
    const double linear = 2.0 * (n + 1.0 / n) / critical * near.cos_t;
    // The next term is quadratic, of about the size of the first one squared.
    slope = std::max(slope, std::abs(1.0 - near.reflectance - linear) / (linear * linear));
  }
  row.measured("distance of 1 - F from its linear term, over its square", slope);
  EXPECT_LE(slope, 2.0);
  row.never("NaN, not unit, inconsistent", bad, tried);
  row.measured("largest error of F", worst);
  row.measured("least F at the doubles", least);
  EXPECT_EQ(bad, 0U);
  EXPECT_LE(worst, 1e-6);
  EXPECT_GE(least, 0.9965);
}

TEST(D02, SchlickOnTheDenseSide) {
  Row row("D02", "n 1.5 from inside, 1e5 steps of angle; from the rare side against Fresnel's equations",
          "largest step <= 0.05 (exact curve 0.034); largest difference 0.0357 at 84.97 degrees, -23.2 % at 55.5 degrees", "both");
  double schlick_step = 0.0, exact_step = 0.0, largest = 0.0, at = 0.0, relative = 0.0, relative_at = 0.0;
  double before_s = 0.04, before_e = 0.04;
  for (int i = 1; i <= 100'000; ++i) {
    const double degrees = 90.0 * i / 100'000.0, c = std::cos(degrees * kDegree);
    const double s = fresnel_schlick(c, 1.5, 1.0).reflectance, e = fresnel_exact(c, 1.5, 1.0).reflectance;
    schlick_step = std::max(schlick_step, std::abs(s - before_s));
    exact_step = std::max(exact_step, std::abs(e - before_e));
    before_s = s;
    before_e = e;
    const double rs = fresnel_schlick(c, 1.0, 1.5).reflectance, re = fresnel_exact(c, 1.0, 1.5).reflectance;
    if (std::abs(rs - re) > largest) largest = std::abs(rs - re), at = degrees;
    if ((rs - re) / re < relative) relative = (rs - re) / re, relative_at = degrees;
  }
  row.measured("largest step, Schlick", schlick_step);
  row.measured("exact", exact_step);
  row.measured("largest difference", largest);
  row.measured("at", at);
  row.measured("lowest relative", relative);
  row.measured("at", relative_at);
  EXPECT_LE(schlick_step, 0.05);
  EXPECT_LE(exact_step, 0.05);
  EXPECT_NEAR(largest, 0.035693, 2e-5);
  EXPECT_NEAR(at, 84.97, 0.02);
  EXPECT_NEAR(relative, -0.232, 5e-4);
  EXPECT_NEAR(relative_at, 55.5, 0.2);
}

/// A board of squares that shine or not, behind whatever stands in front of it.
void add_board(SmallScene& s, float z) {
  const std::array<std::uint32_t, 2> shade{s.material(matte(0.0F, 0.3F)), s.material(matte(0.0F, 1.0F))};
  for (int i = -4; i < 4; ++i) {
    for (int j = -4; j < 4; ++j) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      s.quad({Vec3f(x, y, z), {x + 1, y, z}, {x + 1, y + 1, z}, {x, y + 1, z}}, shade[static_cast<std::size_t>((i + j) & 1)]);
    }
  }
}

void add_ball(SmallScene& s, std::uint32_t material, float radius, bool reversed = false) {
  const TestMesh ball = icosphere(3);
  for (std::size_t i = 0; i < ball.triangles.size(); ++i) {
    auto p = ball.corners(i);
    if (reversed) std::swap(p[1], p[2]);
    s.triangle(radius * p[0], radius * p[1], radius * p[2], material);
  }
}

TEST(D03, IndexOneIsInvisibleInThePhysicalModel) {
  Row row("D03", "ball and slab of index 1 before a board of squares, 64 x 64 at 16 samples, with and without; Fresnel at 0 to 90 degrees",
          "F = 0 at every angle; pixels differ by at most 8u", "physical");
  double largest_f = 0.0;
  for (int i = 0; i <= 900; ++i) largest_f = std::max(largest_f, fresnel_exact(std::max(std::cos(0.1 * i * kDegree), 0.0), 1.0, 1.0).reflectance);
  std::array<std::vector<double>, 3> pictures;
  for (std::size_t kind = 0; kind < 3; ++kind) {
    SmallScene s;
    add_board(s, -1.5F);
    const auto glass = s.material(clear_glass(1.0F));
    if (kind == 1) add_ball(s, glass, 1.0F);
    if (kind == 2) s.box({-2, -2, -0.5F}, {2, 2, 0.5F}, glass);
    s.look({0.3, 0.2, 4.0}, {0, 0, 0}, {0, 1, 0}, 0.8);
    pictures[kind] = measure(s.scene(), square_settings(64, {}, kPhysicalModel), 16).pixels;
  }
  std::uint64_t beyond = 0;
  double largest = 0.0;
  for (std::size_t kind = 1; kind < 3; ++kind) {
    for (std::size_t i = 0; i < pictures[0].size(); ++i) {
      const double d = relative_error(pictures[kind][i], pictures[0][i]) / kUnit;
      beyond += d > 8.0 ? 1U : 0U;
      largest = std::max(largest, d);
    }
  }
  row.measured("largest F", largest_f);
  row.never("pixels beyond 8u", beyond, 2 * pictures[0].size());
  row.measured("largest difference, u", largest);
  EXPECT_EQ(largest_f, 0.0);
  EXPECT_LE(largest, 8.0);
}

TEST(D03, IndexOneShowsSchlicksFloorInTheSeedModel) {
  Members members(403);
  Row row("D03", "slab of index 1 before a backdrop of 1, seen at 0, 60, 85 degrees and 10 members" + members.note(),
          "(1 - F)/(1 + F) with F = (1 - cos)^5, 4 sigma", "seed");
  double worst = 0.0;
  for (int i = 0; i < 13; ++i) {
    const double degrees = i < 3 ? std::array{0.0, 60.0, 85.0}[static_cast<std::size_t>(i)] : members.between(0.0, 86.0);
    SmallScene s;
    const auto glass = s.material(clear_glass(1.0F));
    s.level_square(2000.0F, 0.0F, glass, true);
    s.level_square(2000.0F, -1.0F, glass, false);
    s.level_square(9000.0F, -2.0F, s.material(matte(0.0F, 1.0F)));
    s.look({-20.0 * std::sin(degrees * kDegree), 0, 20.0 * std::cos(degrees * kDegree)}, {0, 0, 0}, {0, 1, 0}, 1e-3);
    RenderSettings settings = square_settings(1, 64, kSeedModel);
    const Measured m = measure(s.scene(), settings, 100'000);
    const double f = std::pow(1.0 - std::cos(degrees * kDegree), 5.0), truth = (1.0 - f) / (1.0 + f);
    EXPECT_TRUE(within_four_sigma(m, truth, 1e-5)) << degrees << ' ' << m.mean << " against " << truth;
    if (m.standard_error > 0.0) worst = std::max(worst, (std::abs(m.mean - truth) - 1e-5) / m.standard_error);
  }
  row.measured("largest |z|", worst);
}

/// The picture of one ball in blocks of 8 x 8 pixels.
std::vector<PixelEstimate> blocks_of_ball(float index, bool reversed, const LightModel& model, std::uint64_t seed,
                                          std::uint64_t samples) {
  SmallScene s;
  add_board(s, -3.0F);
  add_ball(s, s.material(clear_glass(index)), 1.0F, reversed);
  s.look({0.3, 0.2, 4.0}, {0, 0, 0}, {0, 1, 0}, 0.55);
  RenderSettings settings = square_settings(64, 16, model);
  settings.seed = seed;
  const Picture image = picture(s.scene(), settings, samples);
  EXPECT_EQ(image.non_finite, 0U);
  std::vector<PixelEstimate> blocks(64);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    PixelEstimate& block = blocks[i / 64 / 8 * 8 + i % 64 / 8];
    block.mean += image.pixels[i].mean / 64.0;
    block.variance_of_mean += image.pixels[i].variance_of_mean / 4096.0;
  }
  return blocks;
}

TEST(D04, IndexBelowOneAndReversedWinding) {
  Members members(404);
  Row row("D04", "ball of index 1/n against ball of index n with its triangles reversed, n 1.5 at 128 samples, 2 and 2 members "
          "1.1 to 2.5 at 64; 64 x 64 pixels" + members.note(),
          "blocks of 8 x 8 equal within 4 sigma; beyond the critical angle all is reflected", "both");
  std::uint64_t blocks = 0;
  const std::array<double, 4> indices{1.5, 2.0, members.between(1.1, 2.5), members.between(1.1, 2.5)};
  for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
    double worst = 0.0;
    for (const double n : indices) {
      const std::uint64_t samples = tests::kSanitized ? 16 : n == 1.5 ? 128 : 64, seed = members.bits();
      const auto a = blocks_of_ball(static_cast<float>(1.0 / n), false, model, seed, samples);
      const auto b = blocks_of_ball(static_cast<float>(n), true, model, seed + 1, samples);
      for (std::size_t i = 0; i < a.size(); ++i, ++blocks) {
        const double sigma = std::sqrt(a[i].variance_of_mean + b[i].variance_of_mean);
        const double d = std::abs(a[i].mean - b[i].mean);
        if (d > 4.0 * kUnit * a[i].mean) worst = std::max(worst, d / sigma);
      }
    }
    row.measured(name(model) + ", largest |z|", worst);
    EXPECT_LE(worst, 4.0) << name(model);
  }
  row.measured("blocks", blocks);
  const FresnelTerm beyond = fresnel_exact(std::cos(41.82 * kDegree), 1.0, 1.0 / 1.5);
  EXPECT_TRUE(beyond.total_reflection);
  EXPECT_FALSE(fresnel_exact(std::cos(41.80 * kDegree), 1.0, 1.0 / 1.5).total_reflection);
}

// In a body of facets light wanders about until it meets one within the critical angle: the share
// 1 - F_int = (1 - F)/n^2 of what meets a facet gets out. All but what the limit cuts off comes back, and
// each path that is cut off carried exactly 1.
TEST(D05, FacetedBall) {
  Row row("D05", "ball of 528 facets, index 1.5, 2.4, 4 and 10, in a furnace of 1, limit as by default",
          "furnace 1 but for the paths that are counted as truncated: at most 2 % at index 10, none up to 4; none at limit 4096", "physical");
  for (const double n : {1.5, 2.4, 4.0, 10.0}) {
    SmallScene s;
    const auto glass = s.material(clear_glass(static_cast<float>(n)));
    const TestMesh ball = test::sphere(24, 12);
    for (std::size_t i = 0; i < ball.triangles.size(); ++i) {
      const auto p = ball.corners(i);
      s.triangle(p[0], p[1], p[2], glass);
    }
    s.scene().background = Rgb(1.0F);
    s.look({0.3, 0.2, 4.0}, {0, 0, 0}, {0, 1, 0}, 0.3);
    const Measured m = measure(s.scene(), square_settings(16, {}, kPhysicalModel), 32);
    const double cut = static_cast<double>(m.stats.truncated) / static_cast<double>(m.stats.paths);
    row.measured("index " + shown(n) + ": furnace", m.mean);
    row.measured("cut off", cut);
    EXPECT_NEAR(m.mean + cut, 1.0, 1e-5 + 4.0 * kUnit) << n;
    EXPECT_LE(cut, n > 4.0 ? 0.02 : 0.0) << n;
    if (n <= 4.0) continue;
    const Measured longer = measure(s.scene(), square_settings(16, kLargestDepth, kPhysicalModel), 32);
    row.measured("at limit 4096", longer.mean);
    EXPECT_EQ(longer.stats.truncated, 0U);
    EXPECT_NEAR(longer.mean, 1.0, 1e-5 + 4.0 * kUnit);
  }
}

TEST(D05, HugeIndex) {
  Row row("D05", "index 10, 1e3, 1e6, 1e20 and 3.4e38, and 1 over these: head on, at every angle, and a plate in a furnace of 1",
          "((n-1)/(n+1))^2; no NaN; furnace 1 within 4 sigma", "both");
  std::uint64_t bad = 0;
  double worst = 0.0;
  for (const auto& [n, truth] : {std::pair{10.0, 0.669421}, {1e3, 0.996008}, {1e6, 0.999996}, {1e20, 1.0}, {3.4e38, 1.0}}) {
    for (const FresnelFormula formula : {FresnelFormula::kExact, FresnelFormula::kSchlick}) {
      EXPECT_NEAR(fresnel(formula, 1.0, 1.0, n).reflectance, truth, 5e-7);
      for (int i = 0; i <= 900; ++i) {
        const double c = std::max(std::cos(0.1 * i * kDegree), 0.0);
        for (const FresnelTerm& t : {fresnel(formula, c, 1.0, n), fresnel(formula, c, n, 1.0), fresnel(formula, c, 1.0, 1.0 / n)}) {
          bad += t.reflectance >= 0.0 && t.reflectance <= 1.0 && std::isfinite(t.cos_t) ? 0U : 1U;
        }
      }
    }
    for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
      // Parallel faces: what comes in can leave again. At index 1000 that takes 250 reflections.
      SmallScene s;
      const auto glass = s.material(clear_glass(static_cast<float>(n)));
      s.level_square(1000.0F, 0.0F, glass, true);
      s.level_square(1000.0F, -0.01F, glass, false);
      s.scene().background = Rgb(1.0F);
      s.look({0.3, 0.2, 4.0}, {0, 0, 0}, {0, 1, 0}, 0.3);
      RenderSettings settings = square_settings(32, {}, model);
      settings.max_depth = 4096;
      const Measured m = measure(s.scene(), settings, 16);
      bad += m.stats.non_finite;
      EXPECT_TRUE(within_four_sigma(m, 1.0, 1e-4)) << n << ' ' << name(model) << ' ' << m.mean << ' ' << m.standard_error;
      worst = std::max(worst, std::abs(m.mean - 1.0));
    }
  }
  row.measured("NaN or out of [0, 1]", bad);
  row.measured("furnace, largest difference from 1", worst);
  EXPECT_EQ(bad, 0U);
}

}  // namespace
}  // namespace raykiln::hard
