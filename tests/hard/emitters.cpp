// L06-L08: emitters tiny, huge and touching what they light; many lights.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/pictures.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/selftest/direct_light.hpp"
#include "raykiln/selftest/form_factors.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using namespace render::selftest;

RenderSettings direct_only(int side, const LightModel& model, PixelMode mode = PixelMode::kRandom) {
  RenderSettings settings = square_settings(side, 0, model);
  settings.pixel_mode = mode;
  return settings;
}

TEST(L06, VerySmallAndVeryLargeEmitters) {
  Members members(1006);
  Row row("L06", "square emitters of side 1e-4 (radiance 1e8) and 1e6 (radiance 1) at distance 1, emitter sampling" + members.note(),
          "E within 4 sigma", "both");
  const auto check = [&](const SquareOverElement& input) {
    const Outcome outcome = square_over_element(input, true, 1024);
    EXPECT_TRUE(outcome.passed) << outcome.measured;
    return outcome.measured;
  };
  for (const LightModel& model : kBothModels) {
    row.measured(name(model) + ", small", check({.radiance = 1e8, .side = 1e-4, .model = model}));
    row.measured(name(model) + ", large", check({.radiance = 1.0, .side = 1e6, .model = model}));
  }
  for (int i = 0; i < 20; ++i) {
    const double side = members.scale(1e-6, 1e5);
    check({.radiance = members.scale(1e-3, 1e8), .side = side, .height = members.scale(0.1, 10.0),
           .x = members.between(-0.3, 0.3), .model = model_of(static_cast<std::size_t>(i))});
  }
}

TEST(L07, EmitterTouchingTheReceiver) {
  Row row("L07", "perpendicular squares with a common edge, 20 seeds", "0.200044 within 4 sigma each; the claimed sigma covers", "both");
  const double truth = perpendicular_rectangles(1, 1, 1);
  for (const LightModel& model : kBothModels) {
    double chi2 = 0.0, worst = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Measured m = touching_rectangles_picture({.model = model}, true, 128, 700 + seed);
      EXPECT_TRUE(render::selftest::within_four_sigma(m, truth, 2e-6)) << against(m, truth);
      const double z = (m.mean - truth) / m.standard_error;
      chi2 += z * z;
      worst = std::max(worst, std::abs(z));
    }
    row.measured(name(model) + ", largest |z|", worst);
    row.measured("sum of z^2 (20 expected)", chi2);
    EXPECT_LE(chi2, 52.4);  // 1e-4 tails of chi^2 with 20 degrees of freedom
    EXPECT_GE(chi2, 4.4);
  }
}

TEST(L07, SquareCloseToTheReceiver) {
  Row row("L07", "square emitter of side 1 at h = 0.1, 0.01, 0.001", "a Le F, 4 sigma", "both");
  for (std::size_t i = 0; i < 6; ++i) {
    const double h = std::array{0.1, 0.01, 0.001}[i / 2];
    const Outcome outcome = square_over_element({.height = h, .model = model_of(i)}, true, 1024);
    EXPECT_TRUE(outcome.passed) << h << ' ' << outcome.measured;
    row.measured(name(model_of(i)) + ":", outcome.measured);
  }
}

SmallScene walled_floor() {
  SmallScene s;
  s.level_square(1.0F, 0.0F, s.material(matte(0.8F)));
  s.level_square(30.0F, -1.0F, s.material(matte(0.5F)));
  s.look({0.1, 0.2, 0.9}, {0.1, 0.2, 0}, {0, 1, 0}, 1.4);
  return s;
}

TEST(L08, ManyLights) {
  Members members(1008);
  constexpr std::uint64_t kCount = 100'000;
  Row row("L08", shown(static_cast<double>(kCount)) + " point lights, 99.9 % below the floor" + members.note(),
          "equal to the full loop (it is one): the picture of the others alone, to 1e-12", "both");
  SmallScene all = walled_floor(), visible = walled_floor();
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const bool seen = i % 1000 == 7;
    const Vec3f p(static_cast<float>(members.between(-0.5, 0.5)), static_cast<float>(members.between(-0.5, 0.5)),
                  seen ? 0.7F : -0.5F);
    all.point_light(p, Rgb(0.1F));
    if (seen) visible.point_light(p, Rgb(0.1F));
  }
  for (const LightModel& model : kBothModels) {
    const Measured x = measure(all.scene(), direct_only(4, model), 4), y = measure(visible.scene(), direct_only(4, model), 4);
    row.measured(name(model) + ", relative difference", relative_error(x.mean, y.mean));
    row.measured("shadow rays", x.stats.shadow_rays);
    EXPECT_GT(y.mean, 0.0);
    EXPECT_LE(relative_error(x.mean, y.mean), 1e-12);
  }
}

/// Processor seconds of one picture.
double seconds_of(const PreparedScene& scene, const RenderSettings& settings, TileResult& result) {
  const double start = cpu_seconds();
  result = render_tile(scene, settings, {0, 0, settings.width, settings.height}, blocks_for(8), {});
  return cpu_seconds() - start;
}

TEST(L08, LightsWithoutPowerCostNothing) {
  Row row("L08", "100000 point lights of intensity 0", "no shadow ray; the same planes as without; time within 5 %", "both");
  SmallScene none = walled_floor(), zero = walled_floor();
  none.point_light({0.1F, 0.2F, 0.5F}, Rgb(0.1F));
  zero.point_light({0.1F, 0.2F, 0.5F}, Rgb(0.1F));
  for (int i = 0; i < 100000; ++i) zero.point_light({0.0F, 0.1F, 0.5F}, Rgb(0.0F));
  const auto without = prepared(none.scene()), with = prepared(zero.scene());
  for (const LightModel& model : kBothModels) {
    const RenderSettings settings = direct_only(32, model);
    TileResult a, b;
    // The least of many turns of some milliseconds is what a picture takes without others on the
    // machine: asked again until both have had a quiet turn.
    double least_a = kInfinite, least_b = kInfinite;
    for (int i = 0; i < 1000 && (i < 20 || std::abs(least_b / least_a - 1.0) > 0.05); ++i) {
      least_a = std::min(least_a, seconds_of(*without, settings, a));
      least_b = std::min(least_b, seconds_of(*with, settings, b));
    }
    row.measured(name(model) + ", time against without", least_b / least_a);
    row.measured("shadow rays without", a.stats.shadow_rays);
    row.measured("with", b.stats.shadow_rays);
    EXPECT_NEAR(least_b / least_a, 1.0, 0.05);
    EXPECT_EQ(a.stats.shadow_rays, b.stats.shadow_rays);
    ASSERT_EQ(a.blocks.size(), b.blocks.size());
    for (std::size_t i = 0; i < a.blocks.size(); ++i) EXPECT_EQ(a.blocks[i].planes.planes, b.blocks[i].planes.planes);
  }
}

}  // namespace
}  // namespace raykiln::hard
