// T03-T07, T14-T16, T18, T20: pictures of scenes whose answer is known. The first member of each
// class is the scene that also `raykiln selftest` renders.
#include <gtest/gtest.h>

#include <numbers>

#include "hard/support/family.hpp"
#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/selftest/coverage.hpp"
#include "raykiln/selftest/direct_light.hpp"
#include "raykiln/selftest/form_factors.hpp"
#include "raykiln/selftest/refraction.hpp"
#include "raykiln/selftest/selftest.hpp"

namespace raykiln::hard {
namespace {

using namespace render::selftest;
using render::LightModel;

constexpr double kDegree = std::numbers::pi / 180.0;

/// "seed" or "physical".
std::string mode(const LightModel& model) { return render::name(model); }

LightOverPlane random_plane(Members& members, const LightModel& model) {
  const double size = members.scale(1e-3, 1e3);
  return {.albedo = members.between(0.05, 1.0),
          .intensity = members.scale(1e-6, 1e6),
          .height = size * members.between(0.3, 3.0),
          .distance = size * members.between(0.0, 4.0),
          .azimuth_rad = members.between(0.0, 2.0 * std::numbers::pi),
          .model = model};
}

TEST(T03, PointLightAboveADiffusePlane) {
  Members members(3001);
  Row row("T03", "point light over a diffuse plane" + members.note(), "(a/pi) I h/r^3 to 1e-5, no noise",
          "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    LightOverPlane named;
    named.model = model;
    family.named(mode(model), light_over_plane(named));
    for (int i = 0; i < 100; ++i) family.member(light_over_plane(random_plane(members, model)));
  }
}

TEST(T04, PointLightMeanOverASquare) {
  Members members(3002);
  Row row("T04", "point light over a square, mean of the picture" + members.note(), "(a/pi) I Omega/A, 4 sigma", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    family.named(mode(model), light_over_square({.height = 0.5, .distance = 1.0, .model = model}, 4096));
    for (int i = 0; i < 15; ++i) family.member(light_over_square(random_plane(members, model), 256));
  }
}

TEST(T05, SquareEmitterFacingASurfaceElement) {
  Members members(3003);
  Row row("T05", "square emitter over a surface element, with and without emitter sampling" + members.note(),
          "a Le F, 4 sigma", "both");
  Family family(row);
  for (int k = 0; k < 4; ++k) {
    const LightModel& model = kBothModels[static_cast<std::size_t>(k / 2)];
    const bool emitters = k % 2 == 0;
    family.named(mode(model) + (emitters ? ", sampled" : ", not sampled"),
                 square_over_element({.model = model}, emitters, 16384));
    for (int i = 0; i < 10; ++i) {
      const double size = members.scale(1e-3, 1e3);
      const SquareOverElement input{.albedo = members.between(0.05, 1.0),
                                    .radiance = members.scale(1e-3, 1e3),
                                    .side = size,
                                    .height = size * members.between(0.2, 2.0),
                                    .x = size * members.between(-1.0, 1.0),
                                    .y = size * members.between(-1.0, 1.0),
                                    .model = model};
      family.member(square_over_element(input, emitters, 2048));
    }
  }
}

TEST(T06, TwoParallelSquaresWithInterreflection) {
  Members members(3004);
  Row row("T06", "two parallel unit squares that light each other" + members.note(),
          "integral equation (Nystroem), 4 sigma with sigma <= 1e-4", "both");
  const PlateRadiances truth = parallel_squares_truth({});
  EXPECT_NEAR(truth.mean_1, 1.016451, 5e-7);
  EXPECT_NEAR(truth.mean_2, 0.162525, 5e-7);
  EXPECT_NEAR(truth.centre_1, 1.019846, 5e-7);
  EXPECT_NEAR(truth.centre_2, 0.194782, 5e-7);
  Family family(row);
  for (const LightModel& model : kBothModels) {
    // 8 x 8 pixels: 1e6 paths; in the long run sigma 1.2e-5 tells the truth from the 1.016231 and
    // 0.162455 of constant radiosities.
    family.named(mode(model) + ", emitter", parallel_squares({.model = model}, 1, trials(16384, 400000)));
    family.named(mode(model) + ", other", parallel_squares({.model = model}, 2, trials(16384, 400000)));
  }
  for (int i = 0; i < 12; ++i) {
    const ParallelSquares input{.emission = members.scale(1e-2, 1e2),
                                .albedo_1 = members.between(0.0, 1.0),
                                .albedo_2 = members.between(0.1, 1.0),
                                .distance = members.between(0.5, 3.0),
                                .model = model_of(static_cast<std::size_t>(i / 2))};
    family.member(parallel_squares(input, 1 + i % 2, 1024));
  }
}

TEST(T07, PerpendicularSquaresSharingAnEdge) {
  Members members(3005);
  Row row("T07", "perpendicular rectangles with a common edge, with and without emitter sampling" + members.note(),
          "form factor, 4 sigma", "both");
  EXPECT_NEAR(perpendicular_rectangles(1.0, 1.0, 1.0), 0.200044, 5e-7);
  Family family(row);
  for (int k = 0; k < 4; ++k) {
    const LightModel& model = kBothModels[static_cast<std::size_t>(k / 2)];
    const bool emitters = k % 2 == 0;
    family.named(mode(model) + (emitters ? ", sampled" : ", not sampled"),
                 touching_rectangles({.model = model}, emitters, 2048));
    for (int i = 0; i < 5; ++i) {
      const TouchingRectangles input{.receiver = members.between(0.4, 1.0),
                                     .emitter = members.between(0.2, 3.0),
                                     .edge = members.between(0.4, 1.0),
                                     .model = model};
      family.member(touching_rectangles(input, emitters, 256));
    }
  }
}

TEST(T14, PrismAtMinimumDeviation) {
  Members members(3006);
  Row row("T14", "glass prism, sharp lobe" + members.note(), "every path within 1e-5 rad of 2 asin(n sin(A/2)) - A", "physical");
  Family family(row);
  family.named("n 1.5, A 60", prism_deviation(1.5, 60.0 * kDegree, 4096));
  for (int i = 0; i < 40; ++i) {
    const double apex = members.between(20.0, 70.0) * kDegree;
    const double largest = 0.97 / std::sin(0.5 * apex);
    family.member(prism_deviation(members.between(1.1, std::min(2.4, largest)), apex, 1024));
  }
}

TEST(T15, SlabDisplacement) {
  Members members(3007);
  Row row("T15", "edge seen through a glass slab" + members.note(), "shift to 1/4 pixel of 16", "physical");
  EXPECT_NEAR(slab_shift(1.5, 30.0 * kDegree), 0.193814, 5e-7);
  EXPECT_NEAR(slab_shift(1.5, 60.0 * kDegree), 0.512472, 5e-7);
  Family family(row);
  family.named("30 degrees", slab_displacement(1.5, 30.0 * kDegree, 128));
  family.named("60 degrees", slab_displacement(1.5, 60.0 * kDegree, 128));
  for (int i = 0; i < 20; ++i) {
    family.member(slab_displacement(members.between(1.05, 2.4),
                                    members.between(-70.0, 70.0) * kDegree, 128));
  }
}

TEST(T16, TranslucentSheet) {
  Members members(3008);
  Row row("T16", "sheet that scatters to both sides, seen from each" + members.note(), "a/(2 pi) I/h^2, 1e-5", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    LightOverPlane named;
    named.model = model;
    family.named(mode(model), translucent_sheet(named));
    for (int i = 0; i < 50; ++i) family.member(translucent_sheet(random_plane(members, model)));
  }
}

TEST(T18, PixelCoverage) {
  Members members(3009);
  Row row("T18", "half plane over one pixel" + members.note(), "area, 4 sigma; variance a sample p(1-p)");
  EXPECT_DOUBLE_EQ(covered_area({}), 0.5);
  Family family(row);
  family.named("oblique", pixel_coverage({}, 100000));
  family.named("upright", pixel_coverage({1.0, 0.0, 0.25}, 100000));
  for (int i = 0; i < 60; ++i) {
    const double angle = members.between(0.0, 2.0 * std::numbers::pi);
    HalfPlane h{std::cos(angle), std::sin(angle), 0.0};
    h.c = h.a * members.between(0.1, 0.9) + h.b * members.between(0.1, 0.9);
    family.member(pixel_coverage(h, 20000));
  }
}

TEST(T20, ShadowOfASquare) {
  Members members(3010);
  Row row("T20", "point light, square occluder, floor" + members.note(),
          "inside 0, outside the formula, but for one pixel at the edge", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    family.named(mode(model), umbra_of_square({.pixels = 256, .model = model}));
  }
  for (int i = 0; i < 40; ++i) {
    const double size = members.scale(1e-3, 1e3), light = size * members.between(1.5, 6.0);
    family.member(umbra_of_square({.light = light,
                                   .occluder = light * members.between(0.1, 0.6),
                                   .half = size * members.between(0.2, 1.0),
                                   .pixels = 64,
                                   .model = model_of(static_cast<std::size_t>(i))}));
  }
}

// What an installed binary checks by itself.
TEST(Selftest, AllChecksPass) {
  for (const Check& check : all_checks()) {
    const Outcome outcome = check.run();
    EXPECT_TRUE(outcome.passed) << check.id << ' ' << check.input << ": " << outcome.measured;
  }
}

}  // namespace
}  // namespace raykiln::hard
