// M03-M08, M10: sums, counters, random numbers and how fast errors fall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_set>

#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/pictures.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/selftest/coverage.hpp"
#include "raykiln/selftest/form_factors.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using namespace render::selftest;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(M03, TheCompilerKeepsIsnan) {
  Row row("M03", "isnan, isfinite and comparisons in this build", "NaN is told apart");
  volatile double zero = 0.0;
  const double nan = zero / zero, inf = 1.0 / zero;
  EXPECT_TRUE(std::isnan(nan));
  EXPECT_FALSE(std::isfinite(inf));
  EXPECT_FALSE(nan == nan);
  EXPECT_FALSE(nan <= 0.0 || nan >= 0.0);
#ifdef __FAST_MATH__
  ADD_FAILURE() << "built with -ffast-math";
#endif
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
  ADD_FAILURE() << "built with -ffinite-math-only";
#endif
  row.measured("isnan(0/0)", std::uint64_t{1});
}

// What a task does with samples, fed by hand.
TEST(M03, PlantedSamples) {
  Members members(2003);
  const std::uint64_t n = trials(1000000, 10000000);
  Row row("M03", "1e-3 of " + shown(n) + " samples NaN, +Inf, -Inf, too large or negative" + members.note(),
          "counts exact; the mean that of the other samples bit for bit");
  PlaneSet planted = make_block_planes(1), clean = make_block_planes(1);
  std::uint64_t nan = 0, inf = 0, negative = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const Rgbd sample(members.between(0, 2), members.between(0, 2), members.between(0, 2));
    const double which = members.between(0.0, 5000.0);
    if (which >= 5.0) {
      add_sample(planted, 0, sample, false);
      add_sample(clean, 0, sample, false);
    } else if (which >= 4.0) {
      ++negative;
      add_sample(planted, 0, -sample, false);
      add_sample(clean, 0, -sample, false);
    } else {
      Rgbd bad = sample;
      const double value = which < 1.0 ? kNan : which < 2.0 ? kInf : which < 3.0 ? -kInf : 1e39;
      bad[static_cast<int>(members.bits() % 3)] = value;
      (which < 1.0 ? nan : inf) += 1;
      EXPECT_FALSE(add_sample(planted, 0, bad, false));
    }
  }
  const auto at = [&](BlockPlane::Index plane) { return static_cast<std::uint64_t>(planted.planes[plane][0]); };
  row.measured("NaN", at(BlockPlane::kNan));
  row.measured("Inf", at(BlockPlane::kInf));
  row.measured("negative", at(BlockPlane::kNegative));
  EXPECT_EQ(at(BlockPlane::kNan), nan);
  EXPECT_EQ(at(BlockPlane::kInf), inf);
  EXPECT_EQ(at(BlockPlane::kNegative), negative);
  EXPECT_EQ(at(BlockPlane::kSamples), n - nan - inf);
  EXPECT_EQ(planted.planes[BlockPlane::kBeauty], clean.planes[BlockPlane::kBeauty]);
  EXPECT_EQ(planted.planes[BlockPlane::kLuminanceMoment], clean.planes[BlockPlane::kLuminanceMoment]);
}

// A poisoned material in a scene: found by the picture's own paths, located, rendered again.
TEST(M03, LocatedInAPicture) {
  Row row("M03", "a patch whose emission is NaN, +Inf or -Inf in a scene", "counted per pixel, located; that sample alone is bad again", "both");
  std::uint64_t counted = 0, located = 0, again = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double value = std::array{kNan, kInf, -kInf}[i / 2];
    SmallScene s;
    s.level_square(1.0F, 0.0F, s.material(matte(0.5F, 0.25F)));
    s.level_square(0.02F, 0.01F, s.material(matte(0.0F, static_cast<float>(value))));
    s.look({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1.2);
    const RenderSettings settings = square_settings(16, 0, model_of(i));
    const auto ready = prepared(s.scene());
    const auto result = render_tile(*ready, settings, {0, 0, 16, 16}, blocks_for(64), {});
    Film film(16, 16);
    merge(film, result);
    double bad = 0.0, kept = 0.0;
    for (const char* plane : {"nan", "inf"}) {
      for (const double n : film.plane(plane)) bad += n;
    }
    for (const double n : film.plane("samples")) kept += n;
    EXPECT_GT(bad, 0.0);
    EXPECT_EQ(bad, static_cast<double>(result.stats.non_finite));
    EXPECT_EQ(bad + kept, 16.0 * 16.0 * 64.0);
    for (const float x : film.resolve().rgb) EXPECT_EQ(x, 0.25F);
    counted += result.stats.non_finite;
    for (const BadSample& at : result.bad_samples) {
      ++located;
      const SampleBlock one{.index = 0, .first = at.sample, .count = 1, .complete = false};
      const auto replay = render_tile(*ready, settings, {at.x, at.y, at.x + 1, at.y + 1}, std::span(&one, 1), {});
      again += replay.stats.non_finite;
    }
  }
  row.measured("dropped", counted);
  row.measured("located", located);
  row.measured("bad when rendered again", again);
  EXPECT_GT(located, 0U);
  EXPECT_EQ(again, located);
}

/// Folds `n` samples into one pixel block by block, as a job does.
template <typename Sample>
Film accumulate(std::uint64_t n, Sample sample) {
  Film film(1, 1);
  for (std::uint64_t index = 0;; ++index) {
    SampleBlock block = sample_block(index);
    if (block.first >= n) return film;
    block.count = std::min(block.count, n - block.first);
    block.complete = block.count == sample_block(index).count;
    BlockResult result{block, make_block_planes(1)};
    for (std::uint64_t i = 0; i < block.count; ++i) {
      add_sample(result.planes, 0, Rgbd(sample(block.first + i)), false);
    }
    film.fold({0, 0, 1, 1}, result);
  }
}

TEST(M04, ManySamplesInOnePixel) {
  Members members(2004);
  const std::uint64_t n = all_trials(100'000'000), drawn = trials(10'000'000, 100'000'000);
  Row row("M04", shown(static_cast<double>(n)) + " samples of 1, " + shown(drawn) + " uniform in [0, 1)" + members.note(), "|sum - exact|/exact <= 1e-12");
  const Film ones = accumulate(n, [](std::uint64_t) { return 1.0; });
  // Multiples of 2^-24 below 1: their sum fits 64-bit integers, so the exact value is known.
  std::uint64_t exact = 0;
  const Film uniform = accumulate(drawn, [&](std::uint64_t) {
    const std::uint64_t k = members.bits() >> 40;
    exact += k;
    return static_cast<double>(k) * 0x1p-24;
  });
  const double one_error = relative_error(ones.plane("beauty")[0], static_cast<double>(n));
  const double error = relative_error(uniform.plane("beauty")[0], static_cast<double>(exact) * 0x1p-24);
  row.measured("error of ones", one_error);
  row.measured("of uniform", error);
  EXPECT_LE(one_error, 1e-12);
  EXPECT_LE(error, 1e-12);
  EXPECT_EQ(ones.plane("samples")[0], static_cast<double>(n));
}

TEST(M05, VarianceBySubtraction) {
  Members members(2005);
  Row row("M05", "samples m + s (-1..1), m/s = 1 .. 1e7, 1e5 each" + members.note(), "relative error of the variance <= 1e-6, never negative; "
          "merged over blocks to 1e-12 where m/s <= 10");
  double worst = 0.0, merged = 0.0;
  for (int i = 0; i < 24; ++i) {
    const double mean = i == 0 ? 1000.0 : members.scale(1e-3, 1e6),
                 spread = i == 0 ? 0.01 : mean * (i < 20 ? members.scale(1e-7, 1.0) : members.scale(0.1, 10.0));
    std::vector<double> values(100000);
    for (double& v : values) v = mean + spread * members.between(-1.0, 1.0);
    const Film film = accumulate(values.size(), [&](std::uint64_t k) { return values[k]; });
    // Two passes in extended precision.
    long double sum = 0.0L, squares = 0.0L;
    for (const double v : values) sum += luminance(Rgbd(v));
    const long double centre = sum / static_cast<long double>(values.size());
    for (const double v : values) {
      const long double d = static_cast<long double>(luminance(Rgbd(v))) - centre;
      squares += d * d;
    }
    const double moment = film.plane("luminance_moment")[0];
    EXPECT_GE(moment, 0.0);
    const double error = relative_error(moment, static_cast<double>(squares));
    worst = std::max(worst, error);
    // The condition number of a variance is m/s: beyond, the rounding of the samples shows.
    if (mean <= 10.0 * spread) merged = std::max(merged, error);
  }
  row.measured("largest relative error", worst);
  row.measured("where m/s <= 10", merged);
  EXPECT_LE(worst, 1e-6);
  EXPECT_GT(merged, 0.0);
  EXPECT_LE(merged, 1e-12);
}

TEST(M06, CountersBeyond32Bits) {
  Members members(2006);
  const std::uint64_t n = trials(1000000, 10000000);
  Row row("M06", "sample indices about 2^32, 2^42; " + shown(n) + " random keys" + members.note(), "no index wraps, no two keys alike");
  std::uint64_t wrapped = 0, compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t seed = members.bits(), pixel = members.bits() % (1ULL << 26), k = members.bits() % 64;
    for (const std::uint64_t far : {1ULL << 32, 1ULL << 42, 1ULL << 52}) {
      const auto near_bits = random_bits(vertex_key(path_key(seed, pixel, k), 0, 0), Dimension::kPixelX);
      wrapped += near_bits == random_bits(vertex_key(path_key(seed, pixel, far + k), 0, 0), Dimension::kPixelX);
      wrapped += near_bits == random_bits(vertex_key(path_key(seed, pixel, k), far, 0), Dimension::kPixelX);
      wrapped += near_bits == random_bits(vertex_key(path_key(seed, pixel, k), 0, far), Dimension::kPixelX);
      wrapped += near_bits == random_bits(vertex_key(path_key(seed ^ far, pixel, k), 0, 0), Dimension::kPixelX);
      wrapped += near_bits == random_bits(vertex_key(path_key(seed, pixel ^ far, k), 0, 0), Dimension::kPixelX);
      compared += 5;
    }
  }
  std::unordered_set<std::uint64_t> seen;
  std::uint64_t doubles = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const PathKey key = path_key(members.bits() % 4, members.bits() % (1ULL << 36), members.bits() % (1ULL << 42));
    // 64 of 128 bits: by chance two of 1e6 agree with probability 3e-8.
    doubles += seen.insert(key.a).second ? 0 : 1;
  }
  row.never("wrapped", wrapped, compared);
  row.never("alike", doubles, n);
  EXPECT_EQ(wrapped, 0U);
  EXPECT_EQ(doubles, 0U);
}

TEST(M06, ABlockAtTheBorderOf32Bits) {
  Row row("M06", "samples 2^32 - 2 .. 2^32 + 1 of a picture", "differ from samples 2^32 less, counted", "physical");
  SmallScene s;
  s.level_square(1.0F, 0.0F, s.material(matte(0.5F)));
  s.point_light({0.3F, 0.1F, 0.4F}, Rgb(1.0F));
  s.look({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1.2);
  const RenderSettings settings = square_settings(16, 0, kPhysicalModel);
  const auto ready = prepared(s.scene());
  const auto luminances = [&](std::uint64_t first) {
    const SampleBlock block{.index = 0, .first = first, .count = 1, .complete = true};
    return render_tile(*ready, settings, {0, 0, 16, 16}, std::span(&block, 1), {}).blocks[0].planes.planes[0];
  };
  std::uint64_t alike = 0, all = 0;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const auto near = luminances(k), far = luminances((1ULL << 32) + k), before = luminances((1ULL << 32) - 2 + k);
    for (std::size_t i = 0; i < near.size(); ++i) {
      alike += near[i] == far[i] ? 1 : 0;
      alike += before[i] == near[i] ? 1 : 0;
      all += 2;
    }
  }
  row.never("equal values", alike, all);
  EXPECT_EQ(alike, 0U);
}

/// Independent pixels of the same distribution: one point under a square lamp, its own mean removed.
std::vector<double> errors_of_pixels(int side, std::uint64_t seed, std::uint64_t samples,
                                     const LightModel& model) {
  SmallScene s;
  s.level_square(4.0F, 0.0F, s.material(matte(0.8F)));
  s.level_square(0.5F, 0.5F, s.material(matte(0.0F, 1.0F)), false);
  s.look({0.01, 0.02, 0.25}, {0, 0, 0}, {0, 1, 0}, 1e-5);
  RenderSettings settings = square_settings(side, 1, model);
  settings.seed = seed;
  std::vector<double> values = measure(s.scene(), settings, samples).pixels;
  const double truth = 0.8 * element_to_rectangle(-0.5, 0.5, -0.5, 0.5, 0.5);
  for (double& v : values) v -= truth;
  return values;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += a[i] * b[i];
    aa += a[i] * a[i];
    bb += b[i] * b[i];
  }
  return ab / std::sqrt(aa * bb);
}

struct Correlations {
  double rho = 0.0;    ///< largest |rho| sqrt(P)
  double ratio = 0.0;  ///< largest |MSE of an average / MSE - 1/2|
};

Correlations correlations(const LightModel& model, int side) {
  std::vector<std::vector<double>> by_seed;
  for (const std::uint64_t seed : {0, 1, 2, 12345}) by_seed.push_back(errors_of_pixels(side, seed, 1, model));
  const auto row = static_cast<std::size_t>(side);
  Correlations worst;
  for (const auto& errors : by_seed) {
    for (const std::size_t step : {std::size_t{1}, std::size_t{2}, row, row + 1, std::size_t{16}}) {
      const std::vector<double> head(errors.begin(), errors.end() - static_cast<std::ptrdiff_t>(step)),
          tail(errors.begin() + static_cast<std::ptrdiff_t>(step), errors.end());
      worst.rho = std::max(worst.rho, std::abs(correlation(head, tail)));
    }
  }
  for (std::size_t i = 0; i < by_seed.size(); ++i) {
    for (std::size_t j = i + 1; j < by_seed.size(); ++j) {
      worst.rho = std::max(worst.rho, std::abs(correlation(by_seed[i], by_seed[j])));
      double both = 0.0, each = 0.0;
      for (std::size_t k = 0; k < by_seed[i].size(); ++k) {
        const double x = by_seed[i][k], y = by_seed[j][k];
        both += 0.25 * (x + y) * (x + y);
        each += 0.5 * (x * x + y * y);
      }
      worst.ratio = std::max(worst.ratio, std::abs(both / each - 0.5));
    }
  }
  worst.rho *= side;
  return worst;
}

TEST(M07, CorrelatedPixelsAndSeeds) {
  Row row("M07", "102400 pixels of one distribution, seeds 0, 1, 2, 12345",
          "|rho| <= 4/sqrt(P) between neighbours and seeds; the average of two seeds halves the MSE", "both");
  for (const LightModel& model : kBothModels) {
    const Correlations worst = correlations(model, 320);
    row.measured(name(model) + ", largest |rho| sqrt(P)", worst.rho);
    row.measured("largest |MSE ratio - 1/2|", worst.ratio);
    EXPECT_LE(worst.rho, 4.0);
    EXPECT_LE(worst.ratio, 0.02);
  }
}

/// Least-squares slope of log MSE over log n for n = first, 4 first, ..., last.
template <typename MeanSquare>
double slope(MeanSquare mean_square, std::uint64_t first = 4, std::uint64_t last = 4096) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0, k = 0;
  for (std::uint64_t n = first; n <= last; n *= 4, ++k) {
    const double x = std::log(static_cast<double>(n)), y = std::log(mean_square(n));
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (k * sxy - sx * sy) / (k * sxx - sx * sx);
}

double mean_square(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double e : errors) sum += e * e;
  return sum / static_cast<double>(errors.size());
}

/// A level plane under a point light, all of it in one pixel: the radiance is smooth in the place in the pixel.
constexpr double kPlaneHalf = 1.0, kLampHeight = 0.8;
Scene lit_plane() {
  SmallScene s;
  s.level_square(4.0F, 0.0F, s.material(matte(0.8F)));
  s.point_light({0.3F, -0.2F, static_cast<float>(kLampHeight)}, Rgb(1.0F));
  s.look({0, 0, 2.0}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(kPlaneHalf / 2.0));
  return s.scene();
}

/// Mean radiance albedo / pi h / r^3 of a light of intensity 1, by Simpson's rule: good to 1e-9.
double mean_of_lit_plane() {
  constexpr int kSteps = 200;
  const auto weight = [](int i) { return i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0); };
  const double light_x = static_cast<double>(0.3F), light_y = static_cast<double>(-0.2F);
  const auto h = static_cast<double>(static_cast<float>(kLampHeight)), albedo = static_cast<double>(0.8F);
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const double x = kPlaneHalf * (2.0 * i / kSteps - 1.0) - light_x, y = kPlaneHalf * (2.0 * k / kSteps - 1.0) - light_y;
      sum += weight(i) * weight(k) * std::pow(x * x + y * y + h * h, -1.5);
    }
  }
  return albedo * std::numbers::inv_pi * h * sum / (9.0 * kSteps * kSteps);
}

/// Seeds of the slope by Sobol' points; a quarter under a sanitizer, where its bands are twice as wide.
constexpr std::uint64_t kSlopeSeeds = tests::kSanitized ? 25 : 100;
constexpr double kSlopeBand = tests::kSanitized ? 0.4 : 0.2;

/// MSE of a picture of one pixel by Sobol' points against its known mean, over `kSlopeSeeds`.
double mse_of_pixel(const PreparedScene& scene, double truth, std::uint64_t n) {
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = 0;
  settings.sampler = Sampler::kSobol;
  std::vector<double> errors;
  for (std::uint64_t seed = 0; seed < kSlopeSeeds; ++seed) {
    settings.seed = seed;
    errors.push_back(picture(scene, settings, n).mean - truth);
  }
  return mean_square(errors);
}

// From 128 samples on all 4 replicates hold as many, 32 and more. Bands: 4 sigma of a fit through four points
// whose errors scatter by 14 %, and 0.1 for what Owen's rates leave out (n^-3 log n; edges of any direction).
TEST(M08, SlopeOfScrambledSequences) {
  Row row("M08", "scrambled Sobol' points: smooth radiance over a pixel, edge through it; n = 128 .. 8192, 100 seeds",
          "slope of the MSE -2.7 +- 0.2 or steeper where smooth, -1.5 +- 0.2 at the edge");
  const HalfPlane edge{0.8, 0.6, 0.7};
  const auto plane = prepared(lit_plane()), half = prepared(half_plane_scene(edge, 1, 1));
  const double light = mean_of_lit_plane(), covered = covered_area(edge);
  const auto fitted = [](const PreparedScene& scene, double truth) {
    return slope([&](std::uint64_t n) { return mse_of_pixel(scene, truth, n); }, 128, 8192);
  };
  const double smooth = fitted(*plane, light), edged = fitted(*half, covered);
  row.measured("Sobol', smooth", smooth);
  row.measured("Sobol', edge", edged);
  EXPECT_LE(smooth, -2.7 + kSlopeBand);
  EXPECT_NEAR(edged, -1.5, kSlopeBand);
}

TEST(M08, ConvergenceSlope) {
  // Under a sanitizer a quarter of the pictures, so a band twice as wide.
  const std::uint64_t seeds = tests::kSanitized ? 50 : 200;
  const int side = tests::kSanitized ? 8 : 15;
  const double band = tests::kSanitized ? 0.14 : 0.07;
  Row row("M08", "lamp over a point; edge through a pixel; n = 4 .. 4096, 200 replicates and more", "slope of the MSE -1.00 +- 0.07", "both");
  const HalfPlane edge{0.8, 0.6, 0.7};
  const double covered = covered_area(edge);
  const double edged = slope([&](std::uint64_t n) {
    std::vector<double> errors;
    RenderSettings settings;
    settings.width = settings.height = 1;
    settings.max_depth = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      settings.seed = seed;
      errors.push_back(measure(half_plane_scene(edge, 1, 1), settings, n).mean - covered);
    }
    return mean_square(errors);
  });
  for (const LightModel& model : kBothModels) {
    const double smooth =
        slope([&](std::uint64_t n) { return mean_square(errors_of_pixels(side, 77, n, model)); });
    row.measured(name(model) + ", lamp", smooth);
    EXPECT_NEAR(smooth, -1.0, band);
  }
  row.measured("edge", edged);
  EXPECT_NEAR(edged, -1.0, band);
}

TEST(M10, OneSampleNoSample) {
  Row row("M10", "pixels with 0, 1 and 2 samples", "the film marks them by their count, holds no NaN");
  Film film(3, 1);
  BlockResult one{sample_block(0), make_block_planes(2)};
  add_sample(one.planes, 0, Rgbd(0.5), false);
  add_sample(one.planes, 1, Rgbd(0.5), false);
  film.fold({1, 0, 3, 1}, one);
  BlockResult two{sample_block(1), make_block_planes(1)};
  add_sample(two.planes, 0, Rgbd(0.7), false);
  film.fold({2, 0, 3, 1}, two);
  EXPECT_EQ(film.plane("samples"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(film.plane("luminance_moment")[0], 0.0);
  EXPECT_EQ(film.plane("luminance_moment")[1], 0.0);
  EXPECT_NEAR(film.plane("luminance_moment")[2], 0.02, 1e-15);
  for (const float value : film.resolve().rgb) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(film.resolve().rgb[0], 0.0F);
  row.measured("counts", "0, 1, 2");
}

}  // namespace
}  // namespace raykiln::hard
