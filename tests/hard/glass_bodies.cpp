// D07 (warning) and D09 (closed bodies): what a loader says about plates too thin, and where the
// scaling of radiance must cancel.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "hard/support/hard_meshes.hpp"
#include "hard/support/members.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/lint/lint.hpp"
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

/// Whether lint warns of a closed glass plate, 1 wide, with one face at z = 1.
bool warned_of_plate(double thickness) {
  const auto top = 1.0F, bottom = static_cast<float>(1.0 - thickness);
  const TestMesh plate = cube(Vec3f(-0.5F, -0.5F, bottom), Vec3f(0.5F, 0.5F, top));
  std::ostringstream obj;
  obj.precision(9);
  obj << "mtllib a.mtl\nusemtl glass\n";
  for (const Vec3f& p : plate.positions) obj << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const auto& t : plate.triangles) {
    obj << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
  MemoryFiles files;
  files.add("a.mtl", "newmtl glass\nd 0\nTf 1 1 1\nKs 1 1 1\nNs 1000\nNi 1.5\nillum 7\n");
  files.add("a.obj", obj.str());
  const ImportResult result = import_scene(files);
  if (!std::holds_alternative<ImportedScene>(result)) {
    ADD_FAILURE() << "refused at " << thickness;
    return false;
  }
  const auto findings = lint(std::get<ImportedScene>(result));
  return std::any_of(findings.begin(), findings.end(),
                     [](const LintFinding& f) { return f.code == "coarse_edges"; });
}

TEST(D07, PlatesTooThinAreWarnedAbout) {
  Members members(4017);
  Row row("D07", "closed glass plates at |p| = 1, 3e-7 to 1.6e-6 and 1e-2, 1e-4, 1e-5 thick; 40 members" + members.note(),
          "below 4 gamma_7 |p| = 1.67e-6 a warning; none from 1e-5 on", "any");
  std::uint64_t unwarned = 0, needless = 0;
  for (int i = 0; i < 40; ++i) {
    unwarned += warned_of_plate(i == 0 ? 1.6e-6 : members.scale(3e-7, 1.66e-6)) ? 0U : 1U;
  }
  for (const double thickness : {1e-5, 1e-4, 1e-2}) needless += warned_of_plate(thickness) ? 1U : 0U;
  row.never("without a warning", unwarned, 40);
  row.never("warned without need", needless, 3);
  EXPECT_EQ(unwarned, 0U);
  EXPECT_EQ(needless, 0U);
}

/// A closed body of glass, turned, in a lit room; camera and lights outside of it.
SmallScene body_in_room(Members& members, bool ball) {
  SmallScene s;
  const auto glass = s.material(clear_glass(static_cast<float>(members.between(1.1, 2.4))));
  TestRandom random(members.bits());
  TestMesh body = ball ? icosphere(2) : cube(Vec3f(-0.5F), Vec3f(0.5F));
  const Similarity turn = random_rotation(random);
  for (std::size_t i = 0; i < body.triangles.size(); ++i) {
    const auto p = body.corners(i);
    s.triangle(0.5F * turn(p[0]), 0.5F * turn(p[1]), 0.5F * turn(p[2]), glass);
  }
  Material wall = matte(0.5F);
  wall.diffuse = {0.6F, 0.5F, 0.3F};
  s.box(Vec3f(-2), Vec3f(2), s.material(wall), true);
  s.level_square(0.5F, 1.9F, s.material(matte(0.0F, 4.0F)), false);
  s.point_light({-1.3F, 0.8F, 1.1F}, Rgb(2.0F));
  s.look({1.5, 1.1, 0.4}, {0, 0, 0}, {0, 0, 1}, 1.0);
  return s;
}

// Going in multiplies radiance by 1/n^2, coming out by n^2, and roulette is corrected for both: the
// same random numbers give the same paths, with weights that differ by rounding alone.
TEST(D09, ScalingCancelsOutsideOfClosedBodies) {
  Members members(4019);
  Row row("D09", "closed bodies of glass (balls, cubes, n 1.1 to 2.4) in a lit room, camera and lights outside, 12 members, with "
          "and without roulette" + members.note(),
          "with and without scaling of radiance the same picture, 1e-6 a pixel", "physical");
  double worst = 0.0;
  std::uint64_t pixels = 0;
  for (int member = 0; member < 12; ++member) {
    const SmallScene s = body_in_room(members, member % 2 == 0);
    RenderSettings settings;
    settings.width = settings.height = 24;
    settings.max_depth = 32;
    settings.seed = members.bits();
    settings.light_model.roulette = member % 4 < 2;
    const auto with = measure(s.scene(), settings, 4);
    settings.light_model.radiance_scaling = false;
    const auto without = measure(s.scene(), settings, 4);
    EXPECT_GT(with.mean, 0.0);
    for (std::size_t i = 0; i < with.pixels.size(); ++i, ++pixels) {
      const double sum = with.pixels[i] + without.pixels[i];
      if (sum > 0.0) worst = std::max(worst, std::abs(with.pixels[i] - without.pixels[i]) / sum);
    }
  }
  row.measured("largest relative difference", 2.0 * worst);
  row.measured("pixels", pixels);
  EXPECT_LE(2.0 * worst, 1e-6);
}

// An emitter cast into a cube of glass, and one outside seen from within: light that passes the face
// once. Behind the camera's side all is black.
TEST(D09, EmitterInAClosedCube) {
  Members members(4029);
  Row row("D09", "emitter 1 inside a closed glass cube seen from outside, head on, and the reverse; n 1.5 and 6 members" + members.note(),
          "(1 - F)/n^2 outwards, (1 - F) n^2 inwards (physical); 1 - F both ways (seed); 4 sigma", "both");
  double worst = 0.0;
  for (int member = 0; member < 7; ++member) {
    const double n = member == 0 ? 1.5 : members.between(1.05, 2.5);
    const double root = (n - 1.0) / (n + 1.0), f = root * root;
    for (const LightModel& model : {kPhysicalModel, kSeedModel}) {
      for (const bool inside : {false, true}) {
        SmallScene s;
        s.box(Vec3f(-1), Vec3f(1), s.material(clear_glass(static_cast<float>(n))));
        s.level_square(0.5F, inside ? 3.0F : 0.0F, s.material(matte(0.0F, 1.0F)), !inside);
        s.look({0, 0, inside ? 0.5 : 4.0}, {0, 0, inside ? 1.0 : 0.0}, {0, 1, 0}, 1e-4);
        RenderSettings settings;
        settings.width = settings.height = 4;
        settings.max_depth = 1;
        settings.light_model = model;
        const Measured m = measure(s.scene(), settings, 4096);
        const double scale = !model.radiance_scaling ? 1.0 : inside ? n * n : 1.0 / (n * n);
        const double truth = (1.0 - f) * scale;
        EXPECT_TRUE(selftest::within_four_sigma(m, truth, 1e-5 * truth)) << selftest::against(m, truth) << ' ' << n << ' ' << inside;
        worst = std::max(worst, std::abs(m.mean - truth) / m.standard_error);
      }
    }
  }
  row.measured("largest |z|", worst);
}

}  // namespace
}  // namespace raykiln::hard
