#include <gtest/gtest.h>

#include <cmath>

#include "raykiln/shading/caster_cones.hpp"
#include "raykiln/shading/caustic_casters.hpp"

namespace raykiln::render {
namespace {

Material mirror() {
  Material m;
  m.specular = Rgb(0.9F);
  m.specular_exp = 1e15;
  return m;
}

/// Octahedra about places, each face with corners of its own.
class Bodies {
 public:
  void add(const Vec3f& centre, float radius, std::uint32_t material) {
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const auto first = static_cast<std::uint32_t>(scene.mesh.positions.size());
      for (int axis = 0; axis < 3; ++axis) {
        Vec3f way(0.0F);
        way[axis] = (octant >> static_cast<unsigned>(axis) & 1U) != 0 ? radius : -radius;
        scene.mesh.positions.push_back(centre + way);
      }
      scene.mesh.triangles.push_back({first, first + 1, first + 2});
      scene.mesh.material_ids.push_back(material);
    }
  }
  Scene scene;
};

TEST(CausticCasters, AreConnectedMirrorsAndBorders) {
  Bodies bodies;
  bodies.scene.materials = {mirror(), Material{}};
  bodies.scene.materials[1].diffuse = Rgb(0.5F);
  bodies.add({0, 0, 0}, 1.0F, 0);
  bodies.add({5, 0, 0}, 2.0F, 0);
  bodies.add({5, 0.5F, 0}, 0.25F, 0);  // within the sphere of the one before
  bodies.add({0, 9, 0}, 4.0F, 1);      // sends light everywhere
  const std::vector<CausticCaster> found = find_caustic_casters(bodies.scene);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].centre, Vec3d(5, 0, 0));
  EXPECT_EQ(found[0].radius, 2.0);
  EXPECT_EQ(found[1].centre, Vec3d(0.0));
  EXPECT_EQ(found[1].radius, 1.0);
}

TEST(CausticCasters, AreTheLargestOfMany) {
  Bodies bodies;
  bodies.scene.materials = {mirror()};
  for (int i = 0; i < 20; ++i) bodies.add({10.0F * static_cast<float>(i), 0, 0}, 0.1F * static_cast<float>(i + 1), 0);
  const std::vector<CausticCaster> found = find_caustic_casters(bodies.scene);
  ASSERT_EQ(found.size(), kMostCasters);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].centre.x, 190.0 - 10.0 * static_cast<double>(i));
}

TEST(CausticCasters, AreSharpAndSendOnHalfOfTheLight) {
  Material m = mirror();
  EXPECT_TRUE(casts_caustics(m));
  m.specular_exp = 300.0;
  EXPECT_FALSE(casts_caustics(m));
  m = Material{};
  m.model = SurfaceModel::kMicrofacet;
  m.facets.roughness = 0.05;
  m.specular = Rgb(0.04F);
  EXPECT_FALSE(casts_caustics(m)) << "a polished floor";
  m.transparent = 1.0F;
  EXPECT_TRUE(casts_caustics(m)) << "glass";
  m.facets.roughness = 0.4;
  EXPECT_FALSE(casts_caustics(m)) << "frosted glass";
}

CasterCones seen_from(const std::vector<CausticCaster>& casters, const Vec3d& p, double part = 1.0) {
  CasterCones seen;
  see_casters(seen, casters, p, {0, 0, 1}, part);
  return seen;
}

TEST(CasterCones, AreNoneFromWithinFromBelowAndFromAfar) {
  const std::vector<CausticCaster> ball{{Vec3d(0, 0, 3), 1.0}};
  for (const Vec3d& p : {Vec3d(0, 0, 2.5), Vec3d(0, 0, 5), Vec3d(0, 0, -1e3), Vec3d(0, 0, 3)}) {
    const CasterCones seen = seen_from(ball, p);
    EXPECT_EQ(seen.rest, 1.0) << p.z;
    EXPECT_EQ(mixed_pdf(seen, {0, 0, 1}, 0.25), 0.25);
  }
  EXPECT_LT(seen_from(ball, Vec3d(0.0)).rest, 1.0);
}

TEST(CasterCones, TakeABoundedShareOfDirections) {
  std::vector<CausticCaster> balls;
  for (int i = 0; i < 8; ++i) balls.push_back({Vec3d(std::cos(i), std::sin(i), 2.0), 0.9});
  for (const double part : {1.0, 0.25}) {
    const CasterCones seen = seen_from(balls, Vec3d(0.0), part);
    double sum = 0.0;
    for (std::size_t i = 0; i < seen.count; ++i) sum += seen.cones[i].share;
    EXPECT_NEAR(sum, kMostToCasters * part, 1e-12);
    EXPECT_NEAR(seen.rest + sum, 1.0, 1e-12);
  }
}

/// The mixture's density over all directions, by a grid of 1000 by 1000.
TEST(CasterCones, DensitySumsToOne) {
  const std::vector<CausticCaster> balls{{Vec3d(0, 1, 2), 0.7}, {Vec3d(0, 1.5, 2), 0.7}, {Vec3d(-2, 0, 0.1), 0.3}};
  const CasterCones seen = seen_from(balls, Vec3d(0.0));
  constexpr int kGrid = 1000;
  double sum = 0.0;
  for (int i = 0; i < kGrid; ++i) {
    for (int k = 0; k < kGrid; ++k) {
      const Vec3f wi = sample_uniform_sphere((i + 0.5) / kGrid, (k + 0.5) / kGrid);
      sum += mixed_pdf(seen, wi, std::max(static_cast<double>(wi.z), 0.0) / kPi);
    }
  }
  EXPECT_NEAR(sum / (kGrid * kGrid) / kUniformSpherePdf, 1.0, 1e-3);
}

/// A surface under light from everywhere sends on its albedo, with any mixture. 4 sigma: false alarm 1.3e-4.
TEST(CasterCones, MixtureSendsOnTheAlbedo) {
  Material material;
  material.diffuse = Rgb(0.6F);
  const auto matte = make_matte_bsdf<false>(material, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {});
  material.specular = Rgb(0.3F);
  material.specular_exp = 40.0;
  const OpaqueBsdf glossy = make_opaque_bsdf(material, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {});
  const std::vector<CausticCaster> balls{{Vec3d(0, 1, 2), 0.7}, {Vec3d(-2, 0, 0.1), 0.3}};
  const auto mean = [&](const auto& bsdf) {
    const CasterCones seen = seen_from(balls, Vec3d(0.0), diffuse_part(bsdf));
    EXPECT_LT(seen.rest, 1.0);
    double sum = 0.0, square = 0.0;
    constexpr int kCount = 100000;
    for (std::uint64_t i = 0; i < kCount; ++i) {
      const BsdfSample s = sample_mixture(bsdf, seen, vertex_key(path_key(5, i, 0), 0, 0));
      if (s.lobe == Lobe::kNone) continue;
      const BsdfValue value = evaluate(bsdf, s.wi);
      EXPECT_NEAR(s.pdf, mixed_pdf(seen, s.wi, value.pdf), 1e-5 * s.pdf);
      EXPECT_NEAR(s.weight.x * s.pdf, value.f_cos.x, 1e-5 * value.f_cos.x);
      sum += s.weight.x;
      square += s.weight.x * s.weight.x;
    }
    const double average = sum / kCount;
    return std::pair(average, std::sqrt((square / kCount - average * average) / kCount));
  };
  const auto [diffuse, diffuse_error] = mean(matte);
  EXPECT_NEAR(diffuse, 0.6, 4.0 * diffuse_error);
  // (e + 1)/(e + 2) of the lobe's light comes back along the normal, as f is over the larger cosine.
  const auto [both, both_error] = mean(glossy);
  EXPECT_NEAR(both, 0.6 + 0.3 * 41.0 / 42.0, 4.0 * both_error);
}

}  // namespace
}  // namespace raykiln::render
