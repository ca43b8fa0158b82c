// S09 and D06: normals against geometry, and glass that touches what it stands on, in pictures.
#include <gtest/gtest.h>

#include <array>

#include "hard/support/hard_meshes.hpp"
#include "hard/support/lobes.hpp"
#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/report.hpp"
#include "raykiln/selftest/measure.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using render::selftest::clear_glass;
using render::selftest::matte;
using render::selftest::measure;
using render::selftest::Measured;
using render::selftest::SmallScene;

/// 80 faces with the sphere's normals at the corners; `flipped` turns those of every other corner.
SmallScene smooth_ball(const Material& material, bool flipped) {
  SmallScene s;
  const auto id = s.material(material);
  const TestMesh ball = icosphere(1);
  TriangleMesh& mesh = s.scene().mesh;
  for (std::size_t i = 0; i < ball.triangles.size(); ++i) {
    const auto p = ball.corners(i);
    s.triangle(p[0], p[1], p[2], id);
    const auto first = static_cast<std::uint32_t>(mesh.normals.size());
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f n = normalize(p[c]);
      mesh.normals.push_back(flipped && (3 * i + c) % 2 == 0 ? -n : n);
    }
    mesh.corner_normals.push_back({first, first + 1, first + 2});
  }
  return s;
}

TEST(S09, InterpolatedNormalsAgainstGeometry) {
  Members members(1009);
  Row row("S09", "opaque ball of 80 faces with smooth normals, as they are and half of them turned inside out; diffuse and "
          "glossy e 20; 24 point lights and views at random, from outside and inside" + members.note(),
          "never negative, nothing not finite, no light inside", "both");
  std::uint64_t negative = 0, bad = 0, lit_inside = 0, pixels = 0;
  double outside = 0.0;
  for (int member = 0; member < 24; ++member) {
    Material gloss = matte(0.4F);
    if (member % 2 == 1) gloss.specular = Rgb(0.5F), gloss.specular_exp = 20.0;
    SmallScene s = smooth_ball(gloss, member % 4 >= 2);
    const auto direction = [&] {
      return normalize(Vec3d(members.between(-1, 1), members.between(-1, 1), members.between(-1, 1)) + Vec3d(1e-3));
    };
    s.point_light(Vec3f(members.between(1.2, 4.0) * direction()), Rgb(10.0F));
    s.scene().background = Rgb(0.5F);
    for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
      const Vec3d view = direction();
      s.look(3.0 * view, {0, 0, 0}, {0.3, 1.0, 0.2}, 0.9);
      const Measured out = measure(s.scene(), square_settings(32, 8, model), 8);
      s.look(0.3 * view, {0, 0, 0}, {0.3, 1.0, 0.2}, 2.0);
      const Measured in = measure(s.scene(), square_settings(32, 8, model), 8);
      negative += out.stats.negative + in.stats.negative;
      bad += out.stats.non_finite + in.stats.non_finite;
      outside += out.mean;
      for (const double x : in.pixels) lit_inside += x != 0.0 ? 1U : 0U;
      pixels += in.pixels.size();
    }
  }
  row.measured("negative", negative);
  row.measured("not finite", bad);
  row.never("lit pixels inside", lit_inside, pixels);
  EXPECT_EQ(negative, 0U);
  EXPECT_EQ(bad, 0U);
  EXPECT_EQ(lit_inside, 0U);
  EXPECT_GT(outside, 1.0);
}

/// A glass cube whose lower face lies exactly in a diffuse floor, in a closed room; which of the two
/// comes first in the list is `glass_first`.
SmallScene cube_on_floor(bool glass_first, float turn, float emission) {
  SmallScene s;
  const auto glass = s.material(clear_glass(1.5F));
  const auto wall = s.material(matte(1.0F - emission, emission));
  const float c = std::cos(turn), t = std::sin(turn);
  const auto at = [&](float x, float y, float z) { return Vec3f(c * x - t * y, t * x + c * y, z); };
  const auto add_cube = [&] {
    const float h = 0.5F;
    const std::array<Vec3f, 8> p{at(-h, -h, 0), at(h, -h, 0), at(h, h, 0), at(-h, h, 0),
                                 at(-h, -h, 1), at(h, -h, 1), at(h, h, 1), at(-h, h, 1)};
    for (const auto& f : {std::array<std::size_t, 4>{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}) {
      s.quad({p[f[0]], p[f[1]], p[f[2]], p[f[3]]}, glass);
    }
  };
  if (glass_first) add_cube();
  s.box({-3, -3, 0}, {3, 3, 4}, wall, true);
  if (!glass_first) add_cube();
  return s;
}

TEST(D06, TouchingDielectricAndDiffuseFaces) {
  Members members(4006);
  Row row("D06", "glass cube standing in the plane of a diffuse floor, listed before and after it, turned by 6 random angles; 1e6 rays "
          "into the contact from above; the room as a furnace" + members.note(),
          "share of glass among the hits 0 or 1; furnace at most 1 + 4 sigma", "both");
  std::uint64_t mixed = 0, hits = 0;
  double brightest = 0.0;
  for (int member = 0; member < 12; ++member) {
    const bool glass_first = member % 2 == 0;
    SmallScene s = cube_on_floor(glass_first, static_cast<float>(members.between(0.0, 1.5)), 0.5F);
    SerialTaskRunner runner;
    const auto tree = build_scene_tree(s.scene(), {}, runner);
    std::vector<Ray> rays(trials(84'000, 840'000));
    for (Ray& ray : rays) {
      ray.o = Vec3f(Vec3d(members.between(-0.3, 0.3), members.between(-0.3, 0.3), members.between(0.1, 0.9)));
      const Vec3d target(members.between(-0.34, 0.34), members.between(-0.34, 0.34), 0.0);
      ray.d = Vec3f(normalize(target - Vec3d(ray.o)));
    }
    std::vector<Hit> found(rays.size());
    closest_hits(*tree, rays, found);
    std::uint64_t glass = 0;
    for (const Hit& hit : found) glass += hit.id != kNoHit && s.scene().mesh.material_ids[hit.id] == 0 ? 1U : 0U;
    hits += found.size();
    mixed += glass == (glass_first ? found.size() : 0U) ? 0U : 1U;
    s.look({2.0, 1.5, 2.0}, {0, 0, 0.4}, {0, 0, 1}, 0.8);
    for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
      const Measured m = measure(s.scene(), square_settings(16, 48, model), of_a_pixel(16));
      EXPECT_LE(m.mean, 1.0 + 4.0 * m.standard_error + 1e-5) << name(model) << ' ' << glass_first;
      EXPECT_EQ(m.stats.non_finite, 0U);
      brightest = std::max(brightest, m.mean - 4.0 * m.standard_error);
    }
  }
  row.never("scenes with a share other than that of the lowest id", mixed, 12);
  row.measured("hits", hits);
  row.measured("largest furnace mean less 4 sigma", brightest);
  EXPECT_EQ(mixed, 0U);
}

}  // namespace
}  // namespace raykiln::hard
