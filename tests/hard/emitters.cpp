// L06-L08: emitters tiny, huge and touching what they light; many lights.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/pictures.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "hard/support/turns.hpp"
#include "raykiln/render/prepared_bytes.hpp"
#include "raykiln/selftest/direct_light.hpp"
#include "raykiln/selftest/form_factors.hpp"
#include "raykiln/selftest/small_scene.hpp"
#include "raykiln/shading/emitters.hpp"

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

/// Six triangles at random that shine to both sides, of size `size` above a floor, both around `reach` wide and high.
SmallScene splinters_over_floor(Members& members, double size, double reach) {
  SmallScene s;
  s.level_square(static_cast<float>(reach), 0.0F, s.material(matte(0.8F)));
  const auto lamp = s.material(matte(0.0F, 1.0F));
  const Vec3d centre(members.between(-0.1, 0.1) * reach, members.between(-0.1, 0.1) * reach, 0.3 * reach);
  const auto corner = [&] {
    const double x = members.between(-1.0, 1.0), y = members.between(-1.0, 1.0), z = members.between(-1.0, 1.0);
    return Vec3f(centre + size * Vec3d(x, y, z));
  };
  for (int i = 0; i < 6; ++i) {
    const Vec3f a = corner(), b = corner(), c = corner();
    s.triangle(a, b, c, lamp);
    s.triangle(a, c, b, lamp);
  }
  s.look({0, 0, 0.2 * reach}, {0, 0, 0}, {0, 1, 0}, 1.2);
  return s;
}

struct Paired {
  double difference = 0.0, standard_error = 0.0;  ///< of the mean of one, over that of the other
};
/// Without the watertight test against with it, by the same random numbers, in 16 pictures of other seeds. Only paths that
/// come out otherwise make a difference. Its error is that of the pictures' differences: pixels differ for good, up and down.
Paired fast_beside_watertight(const Scene& scene, std::uint64_t samples) {
  constexpr std::uint64_t kPictures = 16;
  RenderSettings with = square_settings(16, 1, kPhysicalModel);
  std::array<double, kPictures> differences{};
  double sum = 0.0, mean = 0.0;
  for (std::uint64_t i = 0; i < kPictures; ++i) {
    with.seed = i;
    RenderSettings without = with;
    without.effects.without.insert(render::Effect::kWatertightTriangles);
    const Measured watertight = measure(scene, with, samples);
    differences.at(i) = measure(scene, without, samples).mean - watertight.mean;
    sum += differences.at(i) / kPictures;
    mean += watertight.mean / kPictures;
  }
  double squares = 0.0;
  for (const double d : differences) squares += (d - sum) * (d - sum);
  EXPECT_GT(mean, 0.0);
  return {sum / mean, std::sqrt(squares / (kPictures * (kPictures - 1.0))) / mean};
}

// Ends of shadow rays keep a distance that is proved for the watertight test: the float one moves triangles by more.
TEST(L07, FarLampsByTheFastTest) {
  Members members(1007);
  constexpr double kMost = tests::kSanitized ? 1.5e-3 : 7.5e-4;  // of fewer samples
  Row row("L07", "splinters of 1e-3 to 1 that shine at 1 to 3e4; without watertight_triangles" + members.note(),
          "the light of the watertight test within 0.075 %, four sigma of the difference or more: 0.1 % would be seen", "physical");
  double worst = 0.0, least_sure = 0.0;
  for (const double size : {1e-3, 0.1, 1.0}) {
    for (const double reach : {1.0, 30.0, 1e3, 3e4}) {
      const SmallScene s = splinters_over_floor(members, size, reach);
      Paired found = fast_beside_watertight(s.scene(), of_a_pixel(64));
      if (4.0 * found.standard_error > kMost) found = fast_beside_watertight(s.scene(), of_a_pixel(512));
      EXPECT_LE(std::abs(found.difference), kMost) << size << ' ' << reach;
      EXPECT_LE(4.0 * found.standard_error, kMost) << size << ' ' << reach;
      worst = std::max(worst, std::abs(found.difference));
      least_sure = std::max(least_sure, found.standard_error);
    }
  }
  row.measured("largest relative difference", worst);
  row.measured("largest sigma", least_sure);
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

std::array<std::uint64_t, 8> counts_of(const TraversalCounters& c) {
  return {c.calls, c.rays, c.node_steps, c.leaf_visits, c.block_tests, c.unusable_rays, c.exact_tests, c.lane_slots};
}

/// A floor under one point light and a hundred thousand of intensity 0, or under the one alone.
Scene lit_by_one(bool and_unlit_ones) {
  SmallScene s = walled_floor();
  s.point_light({0.1F, 0.2F, 0.5F}, Rgb(0.1F));
  for (int i = 0; and_unlit_ones && i < 100'000; ++i) s.point_light({0.0F, 0.1F, 0.5F}, Rgb(0.0F));
  return s.scene();
}

TileResult whole_picture(const PreparedScene& scene, const RenderSettings& settings) {
  return render_tile(scene, settings, {0, 0, settings.width, settings.height}, blocks_for(8), {});
}

TEST(L08, LightsWithoutPowerCostNothing) {
  Row row("L08", "100000 point lights of intensity 0", "left out when the scene is prepared: the same rays, steps and planes as without", "both");
  const Scene none = lit_by_one(false), zero = lit_by_one(true);
  EXPECT_EQ(Emitters(zero).point_lights().size(), 1U);
  const auto without = prepared(none), with = prepared(zero);
  EXPECT_EQ(prepared_bytes(*with), prepared_bytes(*without));
  for (const LightModel& model : kBothModels) {
    const TileResult a = whole_picture(*without, direct_only(32, model)), b = whole_picture(*with, direct_only(32, model));
    row.measured(name(model) + ", shadow rays without", a.stats.shadow_rays);
    row.measured("with", b.stats.shadow_rays);
    EXPECT_EQ(a.stats.camera_rays, b.stats.camera_rays);
    EXPECT_EQ(a.stats.shadow_rays, b.stats.shadow_rays);
    EXPECT_EQ(a.stats.lights_at_hits, b.stats.lights_at_hits);
    EXPECT_EQ(a.stats.closest_calls, b.stats.closest_calls);
    EXPECT_EQ(counts_of(a.stats.traversal), counts_of(b.stats.traversal));
    ASSERT_EQ(a.blocks.size(), b.blocks.size());
    for (std::size_t i = 0; i < a.blocks.size(); ++i) EXPECT_EQ(a.blocks[i].planes.planes, b.blocks[i].planes.planes);
  }
}

// The work is the same, as the test above counts it. Where a scene lies in memory is not, and makes more than
// 5 % now and then, for as long as it lies there and to either side: so each group of turns has scenes of its
// own, and the least is over all of them.
TEST(L08, LightsWithoutPowerTakeNoTime) {
  Row row("L08", "the same, prepared again and again", "time of a picture at most 5 % above that without", "both");
  constexpr double kMost = 1.05;
  for (const LightModel& model : kBothModels) {
    Turns turns;
    for (int group = 0; !turns.enough(5, 200, kMost); ++group) {
      const bool zero_first = group % 2 != 0;  // the later one lies where the earlier one left room
      const auto early = prepared(lit_by_one(zero_first));
      const std::vector<char> between(64 * static_cast<std::size_t>(group) + 16);
      const auto late = prepared(lit_by_one(!zero_first));
      const PreparedScene &with = zero_first ? *early : *late, &without = zero_first ? *late : *early;
      turns.group(20, [&] { whole_picture(without, direct_only(32, model)); },
                  [&] { whole_picture(with, direct_only(32, model)); });
    }
    row.measured(name(model) + ", time against without", turns.ratio());
    EXPECT_LE(turns.ratio(), kMost);
  }
}

}  // namespace
}  // namespace raykiln::hard
