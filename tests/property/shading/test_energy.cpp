// Albedos of the lobes against values known in closed form, both ways of the light.
#include <gtest/gtest.h>

#include "raykiln/shading/fresnel.hpp"
#include "support/bsdf_cases.hpp"

namespace raykiln::render {
namespace {

using support::at_degrees;
using support::bsdf_at;
using support::make_material;
using support::numbered;

constexpr std::uint64_t kSamples = 100000;

struct Mean {
  double sum = 0.0, squares = 0.0, n = 0.0;
  void add(double x) {
    sum += x;
    squares += x * x;
    n += 1.0;
  }
  [[nodiscard]] double value() const { return sum / n; }
  [[nodiscard]] double sigma() const {
    return std::sqrt(std::max(squares / n - value() * value(), 0.0) / n);
  }
};

/// Integral of f cos(theta_i) over wi: what a uniform enclosure of radiance 1 shows.
Mean eye_albedo(const Material& material, double degrees, const BsdfModel& model = {}) {
  const Bsdf bsdf = bsdf_at(material, at_degrees(degrees), model);
  Mean mean;
  for (std::uint64_t i = 0; i < kSamples; ++i) mean.add(sample_bsdf(bsdf, numbered(i)).weight.x);
  return mean;
}

/// Integral of f cos(theta_o) over wo for light that arrives along wi. Directions of view are drawn
/// from the cosine-power lobe about the mirror direction of wi.
Mean light_albedo(double exponent, double degrees, const BsdfModel& model) {
  const Material material = make_material(0.0F, 1.0F, 0.0F, exponent);
  const Vec3f wi = at_degrees(degrees);
  const Vec3f mirror(-wi.x, -wi.y, wi.z);
  Mean mean;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const VertexKey key = numbered(i, 2);
    const double x = sample_one_minus_cos(uniform(key, Dimension::kDirectionU), exponent);
    const Vec3f wo = around_axis(mirror, x, uniform(key, Dimension::kDirectionV));
    if (!(wo.z > 0.0F)) {
      mean.add(0.0);
      continue;
    }
    const double f = evaluate(bsdf_at(material, wo, model), wi).f_cos.x / static_cast<double>(wi.z);
    mean.add(f * static_cast<double>(wo.z) / cosine_power_pdf(x, exponent));
  }
  return mean;
}

struct Row {
  double exponent, degrees, light, eye, max;
};

// Derived by integrating the lobe about its axis: share above the horizon and furnace radiance of
// the seed's lobe; either of the physical one, which is reciprocal.
const std::vector<Row> kTable{
    {1, 0, 1.000000, 0.666667, 0.666667},    {1, 45, 0.853553, 0.712207, 0.634796},
    {1, 60, 0.750000, 0.811997, 0.593269},   {1, 80, 0.586824, 1.573854, 0.531650},
    {1, 85, 0.543578, 2.777384, 0.515848},   {1, 89, 0.508726, 12.494345, 0.503171},
    {10, 0, 1.000000, 0.916667, 0.916667},   {10, 45, 0.996564, 0.917013, 0.842183},
    {10, 60, 0.959068, 0.925349, 0.769528},  {10, 80, 0.714762, 1.203880, 0.605219},
    {10, 85, 0.611457, 1.801393, 0.553509},  {10, 89, 0.522564, 6.931063, 0.510761},
    {100, 0, 1.000000, 0.990196, 0.990196},  {100, 60, 1.000000, 0.990196, 0.926763},
    {100, 80, 0.960300, 0.999231, 0.780633}};

// 60 checks at 4 sigma: false alarm 4e-3. The light albedo is never above 1: energy is conserved in
// this sense. The seed's eye albedo is, near grazing, as documented.
TEST(Energy, PhongLobeInBothSenses) {
  for (const Row& row : kTable) {
    const Material material = make_material(0.0F, 1.0F, 0.0F, row.exponent);
    const Mean to_light = light_albedo(row.exponent, row.degrees, support::kPhysicalBsdf);
    EXPECT_NEAR(to_light.value(), row.max, 4.0 * to_light.sigma() + 1e-5)
        << row.exponent << ' ' << row.degrees;
    const Mean to_eye = eye_albedo(material, row.degrees);
    EXPECT_NEAR(to_eye.value(), row.max, 4.0 * to_eye.sigma() + 1e-5)
        << row.exponent << ' ' << row.degrees;
    const Mean light = light_albedo(row.exponent, row.degrees, support::kSeedBsdf);
    EXPECT_NEAR(light.value(), row.light, 4.0 * light.sigma() + 1e-5) << row.exponent << ' ' << row.degrees;
    EXPECT_LE(light.value(), 1.0 + 4.0 * light.sigma() + 1e-5);
    const Mean eye = eye_albedo(material, row.degrees, support::kSeedBsdf);
    EXPECT_NEAR(eye.value(), row.eye, 4.0 * eye.sigma() + 1e-5) << row.exponent << ' ' << row.degrees;
  }
}

// Exponent 0 fills the half sphere about the mirror direction; the part above the horizon is
// 1 - theta/180. 3 checks at 4 sigma: 2e-4.
TEST(Energy, ExponentZeroIsHalfASphere) {
  for (const double degrees : {0.0, 30.0, 60.0}) {
    const Mean light = light_albedo(0.0, degrees, support::kSeedBsdf);
    EXPECT_NEAR(light.value(), 1.0 - degrees / 180.0, 4.0 * light.sigma() + 1e-5);
  }
}

// Weights that do not sum to 1 are not normalised away. 4 checks at 4 sigma, three models: 8e-4.
TEST(Energy, MixtureKeepsTheAbsorbedPart) {
  struct Mixture {
    float diffuse, specular;
    double truth;
  };
  BsdfModel uniform;
  uniform.direction_sampling = DirectionSampling::kUniformSphere;
  for (const auto& [diffuse, specular, truth] :
       {Mixture{0.3F, 0.4F, 0.666667}, {1.0F, 0.0F, 1.0}, {0.0F, 1.0F, 11.0 / 12.0}, {0.0F, 0.0F, 0.0}}) {
    for (const BsdfModel& model : {support::kSeedBsdf, BsdfModel{}, uniform}) {
      const Mean mean = eye_albedo(make_material(diffuse, specular, 0.0F, 10.0), 0.0, model);
      EXPECT_NEAR(mean.value(), truth, 4.0 * mean.sigma() + 1e-5);
    }
  }
}

/// Integral of f cos(theta_o) over directions of view on the other side of a border, for light that
/// arrives along wi from index `from`. Views are drawn as the refractions of directions w about wi,
/// whose density is that of w times (eta_o^2 cos_o)/(eta_i^2 cos_w).
Mean flux_through(float index, double degrees, double exponent, const BsdfModel& model) {
  const Material glass = make_material(0.0F, 1.0F, 1.0F, exponent, index);
  const Vec3f wi = at_degrees(degrees);
  const bool inside = wi.z < 0.0F;
  const double eta_i = inside ? static_cast<double>(index) : 1.0, eta_o = inside ? 1.0 : static_cast<double>(index);
  const Vec3d n(0.0, 0.0, inside ? -1.0 : 1.0);
  Mean mean;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const VertexKey key = numbered(i, 3);
    const double x = sample_one_minus_cos(uniform(key, Dimension::kDirectionU), exponent);
    const Vec3d w(around_axis(wi, x, uniform(key, Dimension::kDirectionV)));
    const double cos_w = dot(w, n);
    const FresnelTerm border = cos_w > 0.0 ? fresnel_exact(cos_w, eta_i, eta_o) : FresnelTerm{.total_reflection = true};
    if (border.total_reflection || !(border.cos_t > 0.0)) {
      mean.add(0.0);
      continue;
    }
    const Vec3f wo(refract(w, n, cos_w, border.cos_t, eta_i, eta_o));
    const double density = cosine_power_pdf(x, exponent) * (eta_o * eta_o * border.cos_t) / (eta_i * eta_i * cos_w);
    const double f = evaluate(bsdf_at(glass, wo, model), wi).f_cos.x / std::abs(static_cast<double>(wi.z));
    mean.add(f * border.cos_t / density);
  }
  return mean;
}

// Does specular refraction conserve energy? With radiance scaled by (eta_o/eta_i)^2 what passes is
// 1 - F and never more than 1, also for broad lobes; unscaled it is (1 - F) (eta_i/eta_o)^2: a gain
// of n^2 on the way out of glass, a loss of 1/n^2 on the way in. 4 sigma each: false alarm 1e-3.
TEST(Energy, RefractionConservesItOnlyIfRadianceIsScaled) {
  BsdfModel unscaled;
  unscaled.light.radiance_scaling = false;
  for (const float index : {1.5F, 1.0F / 1.5F}) {
    for (const double degrees : {0.0, 30.0, 160.0, 180.0}) {
      const double n = static_cast<double>(index), cosine = std::abs(std::cos(degrees * kPi / 180.0));
      const bool inside = degrees > 90.0;
      const double gain = inside ? n * n : 1.0 / (n * n);
      const double passed = 1.0 - fresnel_exact(cosine, inside ? n : 1.0, inside ? 1.0 : n).reflectance;
      const Mean scaled = flux_through(index, degrees, 1e6, {});
      EXPECT_NEAR(scaled.value(), passed, 4.0 * scaled.sigma() + 2e-3) << index << ' ' << degrees;
      const Mean plain = flux_through(index, degrees, 1e6, unscaled);
      EXPECT_NEAR(plain.value(), gain * passed, 4.0 * plain.sigma() + 5e-3) << index << ' ' << degrees;
    }
    for (double degrees = 0.0; degrees <= 180.0; degrees += 12.0) {
      for (const double exponent : {1.0, 20.0}) {
        const Mean broad = flux_through(index, degrees, exponent, {});
        EXPECT_LE(broad.value(), 1.0 + 4.0 * broad.sigma()) << index << ' ' << degrees << ' ' << exponent;
      }
    }
  }
  EXPECT_GT(flux_through(1.5F, 180.0, 1e6, unscaled).value(), 2.0);
  EXPECT_GT(flux_through(1.5F, 180.0, 1e6, support::kSeedBsdf).value(), 2.0);
}

/// Albedo of facets, by an additive recurrence in four dimensions; with more points next to grazing, where light
/// that met several facets leaves over many powers of ten of cosine^2.
double facet_albedo_at(const Material& material, double roughness, double degrees) {
  BsdfModel unscaled;  // scaled, the inside of glass in a furnace of 1 is n^2 bright
  unscaled.light.radiance_scaling = false;
  const MicrofacetBsdf bsdf = support::facets_at(material, roughness, at_degrees(degrees), unscaled);
  const int points = degrees > 89.5 && degrees < 90.5 ? 32768 : 8192;
  constexpr double kRoot = 1.1673039782614187;  // of x^5 = x + 1
  double sum = 0.0, at[4] = {0.5, 0.5, 0.5, 0.5};
  for (int i = 0; i < points; ++i) {
    double step = 1.0;
    for (double& x : at) {
      step /= kRoot;
      x += step;
      x -= std::floor(x);
    }
    sum += sample_bsdf(bsdf, {.lobe = at[0], .side = at[1], .u = at[2], .v = at[3]}).weight.x;
  }
  return sum / points;
}

// What absorbs nothing is invisible in a furnace, within 1 %: a metal, a white base below a clear layer, a sheet, a body seen
// from outside and from inside, at every roughness and angle.
TEST(Energy, FacetsInAFurnaceAreInvisible) {
  Material metal;
  metal.model = SurfaceModel::kMicrofacet;
  metal.specular = Rgb(1.0F);
  Material plastic = metal, sheet = metal;
  plastic.specular = Rgb(0.04F);
  plastic.diffuse = Rgb(1.0F);
  sheet.transparent = 1.0F;
  sheet.index_of_refraction = 1.5F;
  Material mixed = sheet, body = sheet;
  mixed.transparent = 0.4F;
  body.facets.thin = false;
  Material leaf = plastic;
  leaf.diffuse = Rgb(0.375F);
  leaf.facets.diffuse_through = Rgb(0.625F);
  for (const double roughness : {0.0, 0.01, 0.15, 0.4, 0.7, 1.0}) {
    for (const double degrees : {0.0, 45.0, 75.0, 85.0, 89.0, 90.0 - 1e-6}) {
      for (const Material* m : {&metal, &plastic, &sheet, &mixed, &body, &leaf}) {
        EXPECT_NEAR(facet_albedo_at(*m, roughness, degrees), 1.0, 0.01)
            << m->diffuse.x << m->transparent << m->facets.thin << ' ' << roughness << ' ' << degrees;
      }
      EXPECT_NEAR(facet_albedo_at(body, roughness, 180.0 - degrees), 1.0, 0.01) << roughness << ' ' << degrees;
    }
  }
}

// Light bends about the critical angle of each index, over a range that goes with the roughness: there it is looked for.
TEST(Energy, RoughBodiesOfAnyIndexAreInvisibleInAFurnaceFromInside) {
  Material body;
  body.model = SurfaceModel::kMicrofacet;
  body.transparent = 1.0F;
  body.facets.thin = false;
  for (const float index : {1.1F, 1.22F, 1.8F, 2.4F}) {
    body.index_of_refraction = index;
    const double critical = std::asin(1.0 / static_cast<double>(index)) * 180.0 / kPi;
    for (const double roughness : {0.1, 0.3, 0.4, 0.6, 0.8, 0.97}) {
      for (const double degrees : {0.8 * critical, critical, 0.5 * (critical + 90.0)}) {
        EXPECT_NEAR(facet_albedo_at(body, roughness, 180.0 - degrees), 1.0, 0.01)
            << index << ' ' << roughness << ' ' << degrees;
      }
    }
  }
}

TEST(Energy, DiffuseTransparentLosesNothing) {
  const Mean mean = eye_albedo(make_material(0.7F, 0.0F, 1.0F, 1.0), 70.0);
  EXPECT_NEAR(mean.value(), 0.7, 4.0 * mean.sigma());
}

// A sharp lossless glass shows F + (1 - F) of its surroundings from either side. Exponent 1e12,
// because at 89 degrees into index 10 a spread of 1e-5 inside is 0.6e-2 outside, as much as the
// angle to the horizon: at 1e10 the part of the lobe that is cut off there is 0.2 %.
TEST(Energy, SharpGlassInAFurnaceIsInvisible) {
  BsdfModel unscaled;  // scaled, the inside of glass in a furnace of 1 is n^2 bright
  unscaled.light.radiance_scaling = false;
  for (const float index : {1.0F, 1.5F, 1.0F / 1.5F, 10.0F, 1e6F}) {
    for (const double degrees : {0.0, 30.0, 41.0, 60.0, 89.0, 100.0, 140.0, 180.0}) {
      for (const BsdfModel& model : {support::kSeedBsdf, unscaled}) {
        const Mean mean = eye_albedo(make_material(0.0F, 1.0F, 1.0F, 1e12, index), degrees, model);
        EXPECT_NEAR(mean.value(), 1.0, 4.0 * mean.sigma() + 1e-3) << index << ' ' << degrees;
      }
    }
  }
}

}  // namespace
}  // namespace raykiln::render
