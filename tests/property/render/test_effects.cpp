// Leaving out what a scene does not call for changes not a bit; leaving out what it does call for
// changes the picture, and in the way that the table says.
#include <gtest/gtest.h>

#include <cstring>
#include <thread>

#include "raykiln/accel/kernels.hpp"
#include "support/effect_rooms.hpp"

namespace raykiln::render {
namespace {

Film film_of(const PreparedScene& scene, RenderSettings settings, const EffectChoice& choice,
             std::uint64_t samples, int threads = 1) {
  settings.effects = choice;
  const auto blocks = blocks_for(samples);
  const int bands = threads == 1 ? 1 : std::max(5, threads);
  std::vector<TileResult> results(static_cast<std::size_t>(bands));
  std::vector<std::jthread> running;
  for (int t = 0; t < threads; ++t) {
    running.emplace_back([&, t] {
      for (int band = t; band < bands; band += threads) {
        const PixelRect rect{0, settings.height * band / bands, settings.width,
                             settings.height * (band + 1) / bands};
        results[static_cast<std::size_t>(band)] = render_tile(scene, settings, rect, blocks, {});
      }
    });
  }
  running.clear();
  Film film(settings.width, settings.height);
  for (const TileResult& result : results) merge(film, result);
  return film;
}

bool same(const Film& a, const Film& b, std::string& differing) {
  for (const PlaneSpec& spec : film_planes()) {
    const auto x = a.plane(spec.name), y = b.plane(spec.name);
    if (std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) != 0)
      differing.append(spec.name).append(" ");
  }
  return differing.empty();
}

std::string list(EffectSet set) {
  std::string text;
  for (const EffectRow* row : effect_table()) {
    if (set.contains(row->effect)) text += std::string(" ") + row->name;
  }
  return text;
}

constexpr EffectChoice kAuto{};
constexpr EffectChoice kAll{EffectChoice::Mode::kAll, {}};

void expect_auto_is_all(support::EffectScene s, std::uint64_t samples) {
  const auto scene = s.builder.prepare();
  const Film all = film_of(*scene, s.settings, kAll, samples);
  for (const int threads : {1, 4}) {
    std::string differing;
    EXPECT_TRUE(same(all, film_of(*scene, s.settings, kAuto, samples, threads), differing))
        << s.name << ", threads " << threads << ", planes: " << differing
        << "; called for:" << list(effect_plan(s.settings, s.builder.scene()).called_for);
  }
}

TEST(Effects, AutoIsAllInNamedScenes) {
  for (support::EffectScene s : support::named_effect_scenes()) {
    s.settings.width = 20;
    s.settings.height = 16;
    expect_auto_is_all(s, 5);
    s.settings.light_model = kSeedModel;
    expect_auto_is_all(s, 5);
  }
}

TEST(Effects, AutoIsAllInRandomScenes) {
  EffectSet seen_on, seen_off;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    const support::EffectScene s = support::random_effect_room(seed);
    support::SceneBuilder builder = s.builder;
    const EffectSet called_for = effect_plan(s.settings, builder.scene()).called_for;
    for (const EffectRow* row : effect_table()) {
      (called_for.contains(row->effect) ? seen_on : seen_off).insert(row->effect);
    }
    expect_auto_is_all(s, 3);
  }
  EXPECT_EQ(list(EffectSet::everything() - seen_on), "") << "never called for";
  constexpr EffectSet kAlways{Effect::kDiffuseReflection, Effect::kWatertightTriangles};
  EXPECT_EQ(list(EffectSet::everything() - seen_off - kAlways), "") << "always called for";
}

/// One effect by itself in an otherwise matte room.
TEST(Effects, AutoIsAllWithEachEffectAlone) {
  for (const EffectRow* row : effect_table()) {
    support::EffectScene s = support::effect_room({row->effect});
    s.name = row->name;
    s.settings.max_depth = std::max(*s.settings.max_depth, 2);
    expect_auto_is_all(s, 4);
  }
}

TEST(Effects, AnInertSceneIsBlackWithoutARay) {
  support::EffectScene s = support::matte_point_light();
  s.builder.scene().point_lights[0].intensity = Rgb(0.0F);
  s.settings.width = s.settings.height = 8;
  s.settings.max_depth = 8;
  expect_auto_is_all(s, 2);
  const TileResult dark = support::render_all(*s.builder.prepare(), s.settings, 2);
  EXPECT_EQ(dark.stats.camera_rays + dark.stats.bounce_rays + dark.stats.shadow_rays, 0U);
  EXPECT_EQ(dark.stats.paths, 128U);
}

TEST(Effects, AThousandDeadLightsCostNoShadowRay) {
  support::EffectScene s = support::matte_point_light();
  s.settings.width = s.settings.height = 16;
  const auto before = support::render_all(*s.builder.prepare(), s.settings, 1).stats.shadow_rays;
  for (int i = 0; i < 1000; ++i) s.builder.point_light({0, 0, 0}, Rgb(0.0F));
  EXPECT_EQ(support::render_all(*s.builder.prepare(), s.settings, 1).stats.shadow_rays, before);
}

class EachEffect : public testing::Test {
 protected:
  EachEffect() {
    scene_ = room_.builder.prepare();
    room_.settings.max_depth = 8;
  }
  [[nodiscard]] Film film(const EffectChoice& choice, std::uint64_t samples) const {
    return film_of(*scene_, room_.settings, choice, samples, 2);
  }
  support::EffectScene room_ = support::effect_room(EffectSet::everything());
  std::shared_ptr<const PreparedScene> scene_;
};

TEST_F(EachEffect, LeftOutByNameChangesThePicture) {
  const Film full = film(kAuto, 8);
  for (const EffectRow* row : effect_table()) {
    const EffectChoice without{EffectChoice::Mode::kAuto, {row->effect}};
    RenderSettings settings = room_.settings;
    settings.effects = without;
    EXPECT_TRUE(effect_plan(settings, room_.builder.scene()).approximated().contains(row->effect))
        << row->name;
    EXPECT_NE(full.plane("beauty"), film(without, 8).plane("beauty")) << row->name;
  }
}

TEST_F(EachEffect, WithoutWatertightTrianglesNoThreadAndNoKernelChangesABit) {
  const EffectChoice without{EffectChoice::Mode::kAuto, {Effect::kWatertightTriangles}};
  const Film one = film_of(*scene_, room_.settings, without, 4);
  std::string differing;
  for (const int threads : {2, 7}) {
    EXPECT_TRUE(same(one, film_of(*scene_, room_.settings, without, 4, threads), differing))
        << threads << " threads, planes: " << differing;
  }
  for (const Traversal walk : {Traversal::kBruteForce, Traversal::kScalar, Traversal::kAvx2, Traversal::kAvx512}) {
    room_.settings.traversal = walk;
    EXPECT_TRUE(same(one, film_of(*scene_, room_.settings, without, 4), differing))
        << name(walk) << ", planes: " << differing;
  }
}

struct Mean {
  double value = 0.0, variance = 0.0;
};

Mean mean_of(const Film& film) {
  const auto sum = film.plane("beauty");
  const auto count = film.plane("samples"), moment = film.plane("luminance_moment");
  Mean mean;
  double samples = 0.0;
  for (std::size_t i = 0; i < count.size(); ++i) {
    mean.value += luminance(Rgbd(sum[3 * i], sum[3 * i + 1], sum[3 * i + 2]));
    mean.variance += count[i] * moment[i] / (count[i] - 1.0);
    samples += count[i];
  }
  mean.value /= samples;
  mean.variance /= samples * samples;
  return mean;
}

/// False alarms: 15 comparisons at 4 standard errors, below 1e-3.
TEST_F(EachEffect, LeftOutByNameChangesItAsItsGradeSays) {
  room_.settings.max_depth = 24;
  const Mean full = mean_of(film(kAuto, 64));
  for (const EffectRow* row : effect_table()) {
    if (row->grade == Grade::kUnbounded) continue;
    room_.settings.seed = 7 + static_cast<std::uint64_t>(row->effect);
    const Mean less = mean_of(film({EffectChoice::Mode::kAuto, {row->effect}}, 64));
    const double sigma = std::sqrt(full.variance + less.variance);
    EXPECT_LE(less.value, full.value + 4.0 * sigma) << row->name;
    if (row->grade != Grade::kUnbiased) continue;
    EXPECT_GE(less.value, full.value - 4.0 * sigma) << row->name;
  }
}

}  // namespace
}  // namespace raykiln::render
