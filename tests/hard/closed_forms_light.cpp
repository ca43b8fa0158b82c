// T01, T02, T08-T13, T17, T19: closed forms that concern lobes, borders and long paths, and D07-D09.
// The first member of each class is the scene that also `raykiln selftest` renders.
#include <gtest/gtest.h>

#include <array>

#include "hard/support/family.hpp"
#include "hard/support/lobes.hpp"
#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/report.hpp"
#include "raykiln/selftest/enclosures.hpp"
#include "raykiln/selftest/glass.hpp"
#include "raykiln/selftest/mirrors.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using namespace render::selftest;

/// Without roulette a path takes all 128 reflections, and the scenes of enclosures take one sample
/// where roulette takes 16; the named members here take as many in both models.
std::uint64_t equally_many(const LightModel& model, std::uint64_t samples) {
  return model.roulette || tests::kSanitized ? samples : 16 * samples;
}

/// Where a long path counts for 16 samples there are few already.
std::uint64_t fewer(const LightModel& model, std::uint64_t samples) {
  return model.roulette ? of_a_pixel(samples) : samples;
}

TEST(T01, WhiteFurnace) {
  Members members(5001);
  Row row("T01", "closed room that emits 1 - rho, rho 0.5; empty, with glass, mirror, translucent box; members: rho 0.1 to 0.9" +
          members.note(), "1 for every pixel, 4 sigma", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    family.named(name(model), furnace(0.5, FurnaceGuest::kNone, model, equally_many(model, fewer(model, 64))));
    for (const auto guest : {FurnaceGuest::kGlass, FurnaceGuest::kMirror, FurnaceGuest::kLeaf}) {
      family.member(furnace(0.5, guest, model, fewer(model, 64)));
      family.member(furnace(members.between(0.1, 0.9), guest, model, fewer(model, 32)));
    }
  }
}

TEST(T02, DepthTruncatedFurnace) {
  Members members(5002);
  Row row("T02", "the same after D reflections: rho 0.8 D 4, 8; rho 0.9 D 4, 16; rho 0.5 D 4; 20 members; roulette without limit" +
          members.note(), "E (1 - rho^(D+1))/(1 - rho): 1e-5 (cosine directions), 4 sigma (uniform); roulette: 1", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    for (const auto& [rho, depth] : {std::pair{0.8, 4}, {0.8, 8}, {0.9, 4}, {0.9, 16}, {0.5, 4}}) {
      family.named("rho " + shown(rho) + " D " + std::to_string(depth) + " " + name(model),
                   truncated_furnace(rho, depth, fixed_depth(model), 16));
    }
    for (int i = 0; i < 20; ++i) {
      family.member(truncated_furnace(members.between(0.1, 0.95), static_cast<int>(members.between(0.0, 20.0)),
                                      fixed_depth(model), 16));
    }
  }
  family.named("roulette", furnace(0.8, FurnaceGuest::kNone, kPhysicalModel, 256));
}

TEST(T08, IntegratingSphereWithALight) {
  Members members(5008);
  Row row("T08", "UV sphere 64 x 128, point light pi in its centre, rho 0.5; 3 members" + members.note(),
          "rho/(1 - rho): 4 sigma + 0.2 %", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    family.named(name(model), sphere_with_light(0.5, model, equally_many(model, 64)));
    for (int i = 0; i < 3; ++i) family.member(sphere_with_light(members.between(0.1, 0.9), model, 32));
  }
}

TEST(T09, IntegratingSphereWithACap) {
  Members members(5009);
  Row row("T09", "sphere with a cap of 10 % that emits 2: albedo 0.8 everywhere, and a black cap; members" + members.note(),
          "0.8 and 0.571429 with the mesh's own share of the cap: 4 sigma + 0.3 %", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    for (const bool black : {false, true}) {
      family.named(name(model) + (black ? ", black cap" : ""), sphere_with_cap(0.8, black, model, equally_many(model, 64)));
      family.member(sphere_with_cap(members.between(0.2, 0.9), black, model, 32));
    }
  }
}

TEST(T10, MirrorCorridor) {
  Members members(5010);
  Row row("T10", "facing mirrors k 0.9 and 0.8 that emit 0.3 and 0.05, e 1e12, after 0, 1, 2, 3, 4, 10, 20, 128 reflections; 10 members" +
          members.note(), "1e-4 + 4 sigma", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    for (const int depth : {0, 1, 2, 3, 4, 10, 20, 128}) {
      const Outcome outcome = mirror_corridor({}, depth, fixed_depth(model), 64);
      if (depth == 20 || depth == 128) family.named(name(model) + " D " + std::to_string(depth), outcome);
      else family.member(outcome);
    }
    for (int i = 0; i < 10; ++i) {
      family.member(mirror_corridor({members.between(0.2, 0.95), members.between(0.2, 0.95), members.between(0.0, 1.0),
                                     members.between(0.0, 1.0)}, static_cast<int>(members.between(0.0, 60.0)), fixed_depth(model), 64));
    }
  }
  family.named("with roulette", mirror_corridor({}, 128, kPhysicalModel, 4096));
}

TEST(T11, FurnaceOnThePhongLobe) {
  Members members(5011);
  Row row("T11", "plane with a lobe of e 1, 10, 100 in surroundings of 1, seen at 0, 60, 80, 89 degrees; 16 members" + members.note(),
          "table of albedos, 4 sigma at 1e6", "both");
  Family family(row);
  for (const bool seed : {false, true}) {
    const LightModel model = seed ? kSeedModel : kPhysicalModel;
    const Albedo column = seed ? Albedo::kEye : Albedo::kMax;
    for (const double e : {1.0, 10.0, 100.0}) {
      for (const double degrees : {0.0, 60.0, 80.0, 89.0}) {
        const double theta = degrees * kDegree;
        const Outcome outcome = lobe_in_furnace(e, theta, phong_albedo(column, e, theta), 3e-5, model, all_trials(1'000'000));
        if (e == 10.0) family.named(name(model) + " at " + shown(degrees), outcome);
        else family.member(outcome);
      }
    }
    for (int i = 0; i < 8; ++i) {
      const double e = members.scale(0.3, 1e3), theta = members.between(0.0, 88.0) * kDegree;
      family.member(lobe_in_furnace(e, theta, phong_albedo(column, e, theta), 1e-4, model, all_trials(200'000)));
    }
  }
}

TEST(T12, GlassSlab) {
  Members members(5012);
  Row row("T12", "slab n 1.5 before a backdrop of 1, at 0, 30, 60, 85 degrees, at 60 also after 0, 1, 2 round trips; 20 members" +
          members.note(), "(1 - F)/(1 + F) by the model's formula, 4 sigma at 1e6", "both");
  EXPECT_NEAR(slab_transmittance(0.04, -1), 0.923077, 5e-7);
  Family family(row);
  for (const LightModel& model : kBothModels) {
    for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
      family.named(name(model) + " at " + shown(degrees), slab(1.5, degrees * kDegree, -1, fixed_depth(model), all_trials(1'000'000)));
    }
    for (int k = 0; k < 3; ++k) family.member(slab(1.5, 60.0 * kDegree, k, fixed_depth(model), all_trials(1'000'000)));
    for (int i = 0; i < 10; ++i) {
      family.member(slab(members.between(1.05, 2.5), members.between(0.0, 86.0) * kDegree, -1, model, all_trials(100'000)));
    }
  }
}

TEST(T13, WindowFromBelow) {
  const int side = tests::kSanitized ? 64 : 128;
  Members members(5013);
  Row row("T13", "looking up from under a surface of n 1.33 and 1.5, pixel centres; 8 members" + members.note(),
          "radius h tan(asin(1/n)) to 1 pixel, 0 beyond", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    for (const double n : {1.33, 1.5}) family.named(name(model) + " n " + shown(n), window_from_below(n, model, side));
    for (int i = 0; i < (tests::kSanitized ? 1 : 4); ++i) family.member(window_from_below(members.between(1.1, 2.5), model, side));
  }
}

TEST(T17, FluxOutOfADielectric) {
  Members members(5017);
  Row row("T17", "diffuse emitter inside n 1.5 under a plane border, flux collected by a white patch; physical, seed, physical "
          "without scaling, seed with scaling; 8 members" + members.note(),
          "0.403654, 0.914286 (Schlick), 0.908222, 0.406349: 4 sigma", "both");
  EXPECT_NEAR((1.0 - average_reflectance(1.5, FresnelFormula::kExact)) / 2.25, 0.403654, 1e-6);
  EXPECT_NEAR(1.0 - average_reflectance(1.5, FresnelFormula::kSchlick), 0.914286, 1e-6);
  LightModel unscaled = kPhysicalModel, scaled = kSeedModel;
  unscaled.radiance_scaling = false;
  scaled.radiance_scaling = true;
  Family family(row);
  for (const LightModel& model : {kPhysicalModel, kSeedModel, unscaled, scaled}) {
    family.named(name(model), flux_out_of_glass(1.5, model, all_trials(4096)));
    for (int i = 0; i < 2; ++i) family.member(flux_out_of_glass(members.between(1.05, 2.5), model, 512));
  }
}

TEST(D09, RadianceAcrossABorder) {
  Members members(4009);
  Row row("D09", "a border of n 1.5 head on, emitter inside seen from outside and the reverse; 8 members" + members.note(),
          "(1 - F)/n^2 outwards, (1 - F) n^2 inwards (physical); 1 - F both ways (seed)", "both");
  Family family(row);
  for (const LightModel& model : kBothModels) {
    for (const bool inside : {false, true}) {
      family.named(name(model) + (inside ? " inwards" : " outwards"), radiance_across_border(1.5, inside, model, 4096));
      for (int i = 0; i < 2; ++i) family.member(radiance_across_border(members.between(1.05, 3.0), inside, model, 4096));
    }
  }
}

TEST(T19, MirrorImageOfAPointLight) {
  Row row("T19", "point light 10 at 3 from a mirror seen from 2, e 1e4 and 100, 32 pictures of 64 x 64 at 16 samples",
          "sum of radiance times solid angle: 0.399995, 0.399524 (seed), 0.399987, 0.398743 (physical), 4 sigma", "both");
  Family family(row);
  family.named("physical 1e4", mirror_image(1e4, 0.399987, kPhysicalModel, of_a_pixel(16)));
  family.named("physical 100", mirror_image(100.0, 0.398743, kPhysicalModel, of_a_pixel(16)));
  family.named("seed 1e4", mirror_image(1e4, 0.399995, kSeedModel, of_a_pixel(16)));
  family.named("seed 100", mirror_image(100.0, 0.399524, kSeedModel, of_a_pixel(16)));
}

TEST(S11, PointLightSeenInAGlossyMirror) {
  Row row("S11", "the scene of T19 at e 1e4, more than 1e3 lit pixels; e 1e10: a highlight that no pixel resolves",
          "0.4 conserved, 4 sigma; at 1e10 nothing is not finite, and the report says that it is unresolved", "both");
  Family family(row);
  family.named("physical", mirror_image(1e4, 0.399987, kPhysicalModel, of_a_pixel(32)));
  family.named("seed", mirror_image(1e4, 0.399995, kSeedModel, of_a_pixel(32)));
  for (const LightModel& model : kBothModels) {
    SmallScene s;
    Material mirror;
    mirror.specular = Rgb(1.0F);
    mirror.specular_exp = 1e10;
    s.level_square(1000.0F, 0.0F, s.material(mirror));
    s.point_light({0, 0, 3}, Rgb(10.0F));
    s.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 1e-4);
    RenderSettings settings;
    settings.width = settings.height = 64;
    settings.max_depth = 0;
    settings.light_model = model;
    const Measured m = measure(s.scene(), settings, 16);
    EXPECT_EQ(m.stats.non_finite, 0U);
    row.measured(name(model) + " at 1e10, share of samples lit", m.contributions / m.samples);
    // That camera looks through a keyhole; through an ordinary one a pixel is wider than the highlight.
    s.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7);
    const auto notices = render_notices(settings, s.scene(), {});
    ASSERT_EQ(notices.size(), 1U);
    EXPECT_EQ(notices[0].code, "unresolved_sharp_highlight");
    s.scene().materials[0].specular_exp = 1e4;
    EXPECT_TRUE(render_notices(settings, s.scene(), {}).empty());
  }
}

TEST(S10, ChainsOfSharpLobes) {
  Members members(1010);
  Row row("S10", "facing mirrors e 1e10, specular 0.9, 40 reflections to an emitter; 10 members of 5 to 60 reflections" + members.note(),
          "0.9^40 (physical: less 1e-6 a reflection, the width of the lobe), 4 sigma + 160u; no Inf", "both");
  Family family(row);
  const auto chain = [&](double k, int reflections, const LightModel& model) {
    SmallScene s;
    Material mirror;
    mirror.specular = Rgb(static_cast<float>(k));
    mirror.specular_exp = 1e10;
    const auto material = s.material(mirror);
    s.level_square(200.0F, 1.0F, material, false);
    s.level_square(200.0F, 0.0F, material, true);
    // A quarter of a unit sideways each time; the emitter stands across the corridor.
    const auto x = static_cast<float>(0.25 * reflections);
    s.quad({Vec3f(x, -9, 0.0F), {x, 9, 0.0F}, {x, 9, 1.0F}, {x, -9, 1.0F}}, s.material(matte(0.0F, 1.0F)));
    s.look({0, 0, 0.5}, {0.25, 0, 1.5}, {0, 1, 0}, 1e-5);
    RenderSettings settings;
    settings.width = settings.height = 8;
    settings.max_depth = reflections;
    settings.light_model = model;
    settings.emitter_sampling = false;
    const Measured m = measure(s.scene(), settings, 64);
    // Over the larger cosine a lobe of finite width keeps E min(1, cos_i/cos_o) of the light. About an axis
    // at angle t, cos_i/cos_o = cos a + tan t sin a cos p, p uniform and a^2/2 exponential of mean 1/e. For
    // large e the loss is tan t E(a) E(max(0, -cos p)) = tan t sqrt(pi/(2 e)) / pi = tan t / sqrt(2 pi e):
    // 1e-6 a reflection here, as table P has 1 - 0.9555 for e = 100 at 45 degrees (this gives 0.040 + 1/e).
    const double kept = model.phong == PhongCosine::kMax ? 1.0 - 0.25 / std::sqrt(2.0 * kPi * 1e10) : 1.0;
    const double truth = std::pow(static_cast<double>(mirror.specular.x) * kept, reflections);
    return statistically(m, truth, 160.0 * kUnit);
  };
  for (const LightModel& model : kBothModels) {
    family.named(name(model), chain(0.9, 40, fixed_depth(model)));
    for (int i = 0; i < 5; ++i) family.member(chain(members.between(0.8, 1.0), static_cast<int>(members.between(5.0, 60.0)), fixed_depth(model)));
  }
}

TEST(D07, ThinPlates) {
  Members members(4007);
  Row row("D07", "plates of n 1.5 from 1e-2 to 1.7e-6 thick at |p| = 1, head on; 8 members; 1e5 samples" + members.note(),
          "(1 - F)/(1 + F), 4 sigma; a path that left after an odd number of faces would weigh 1/n^2: none", "both");
  std::uint64_t odd = 0, paths = 0;
  double worst = 0.0;
  const auto check = [&](double thickness, double n, const LightModel& model) {
    SmallScene s;
    const auto glass = s.material(clear_glass(static_cast<float>(n)));
    s.level_square(1.0F, 1.0F, glass, true);
    s.level_square(1.0F, static_cast<float>(1.0 - thickness), glass, false);
    s.level_square(9.0F, -1.0F, s.material(matte(0.0F, 1.0F)));
    s.look({0.01, 0.02, 2}, {0, 0, 0}, {0, 1, 0}, 0.01);
    RenderSettings settings;
    settings.width = settings.height = 316;  // one sample a pixel, so that every path shows itself
    settings.max_depth = 128;
    settings.light_model = fixed_depth(model);
    settings.emitter_sampling = false;
    const Measured m = measure(s.scene(), settings, 1);
    Samples all;
    for (const double x : m.pixels) {
      all.add(x);
      odd += x == 0.0 || std::abs(x - 1.0) < 1e-3 ? 0U : 1U;
    }
    paths += m.pixels.size();
    const double root = (n - 1.0) / (n + 1.0), f = root * root;
    EXPECT_EQ(within_four_sigma(all, (1.0 - f) / (1.0 + f), 1e-5), Verdict::kAccepted)
        << thickness << ' ' << n << ' ' << all.mean;
    worst = std::max(worst, std::abs(all.mean - (1.0 - f) / (1.0 + f)) / all.standard_error());
  };
  for (const double thickness : {1e-2, 1e-4, 1e-5, 1.7e-6}) {
    for (const LightModel& model : kBothModels) check(thickness, 1.5, model);
  }
  for (int i = 0; i < 8; ++i) check(members.scale(1.7e-6, 1e-1), members.between(1.1, 2.5), kPhysicalModel);
  row.measured("largest |z|", worst);
  row.never("paths after an odd number of faces", odd, paths);
  EXPECT_EQ(odd, 0U);
}

TEST(D08, LightTrappedForEver) {
  Members members(4008);
  Row row("D08", "inside a cube of n 1.5 along (1,1,1), and 40 members between the critical angles" + members.note(),
          "every path ends at the hard limit and is counted; radiance 0", "both");
  std::uint64_t truncated = 0, paths = 0;
  double brightest = 0.0;
  for (int member = 0; member <= (tests::kSanitized ? 10 : 40); ++member) {
    Vec3d d(1, 1, 1);
    if (member > 0) {
      do {
        d = normalize(Vec3d(members.between(-1, 1), members.between(-1, 1), members.between(-1, 1)));
      } while (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) > 0.70);
    }
    SmallScene s;
    s.box(Vec3f(-1.0F), Vec3f(1.0F), s.material(clear_glass(1.5F)));
    s.scene().background = Rgb(1.0F);
    s.look({0.1, 0.2, 0.05}, Vec3d(0.1, 0.2, 0.05) + d, {0.3, 1, 0.1}, 0.01);
    RenderSettings settings;
    settings.width = settings.height = 8;
    settings.max_depth = 128;
    settings.light_model = member % 2 == 0 ? kPhysicalModel : kSeedModel;
    const Measured m = measure(s.scene(), settings, 16);
    truncated += m.stats.truncated;
    paths += m.stats.paths;
    brightest = std::max(brightest, m.mean);
  }
  row.measured("counted as truncated", shown(truncated) + " of " + shown(paths));
  row.measured("largest radiance", brightest);
  EXPECT_EQ(truncated, paths);
  EXPECT_EQ(brightest, 0.0);
}

}  // namespace
}  // namespace raykiln::hard
