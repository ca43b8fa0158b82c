// What the hard cases of shading share: albedos of the Phong lobe by quadrature, light models, and
// means of BSDF samples.
#pragma once

#include <cmath>
#include <string>

#include "hard/support/rules.hpp"
#include "raykiln/sampling/warp.hpp"
#include "support/bsdf_cases.hpp"

namespace raykiln::hard {

inline constexpr double kDegree = render::kPi / 180.0;

/// The columns of the table of albedos of a Phong lobe about an axis at `theta` from the normal.
enum class Albedo {
  kLight,  ///< seed, over directions of view: the share of the lobe above the horizon
  kEye,    ///< seed, over directions of light: m / cos(theta)
  kMax,    ///< physical, either way: min(1, m / cos(theta))
};

/// Midpoint rule in u = cos^(e+1)(a), uniform for the lobe, and the azimuth about the axis.
inline double phong_albedo(Albedo kind, double exponent, double theta) {
  constexpr int kRings = 2000, kTurns = 500;
  const double c = std::cos(theta), s = std::sin(theta);
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i) {
    const double x = render::sample_one_minus_cos((i + 0.5) / kRings, exponent);
    const double along = c * (1.0 - x), across = s * std::sqrt(x * (2.0 - x));
    for (int j = 0; j < kTurns; ++j) {
      const double m = along + across * std::cos(render::kPi * (j + 0.5) / kTurns);
      if (!(m > 0.0)) continue;
      sum += kind == Albedo::kLight ? 1.0 : kind == Albedo::kEye ? m / c : std::min(1.0, m / c);
    }
  }
  return sum / (static_cast<double>(kRings) * kTurns);
}

/// Weights of n samples of the BSDF seen along `wo`: their mean is what an enclosure of radiance 1
/// shows there.
struct Weights {
  Samples x;
  double largest = 0.0;
  std::uint64_t bad = 0;
};

inline Weights weights(const render::Bsdf& bsdf, std::uint64_t n, std::uint64_t seed = 1) {
  Weights w;
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto sample = render::sample_bsdf(bsdf, render::support::numbered(i, seed));
    const double x = sample.weight.x;
    w.bad += std::isfinite(x) && x >= 0.0 ? 0U : 1U;
    w.x.add(x);
    w.largest = std::max(w.largest, x);
  }
  return w;
}

/// f cos(theta_o) over directions of view, for light along `wi`: what of its flux leaves again.
/// Directions are drawn from the lobe of this exponent about the mirror direction of wi.
inline Samples flux_reflected(const render::Material& material, const render::BsdfModel& model,
                              const render::Vec3f& wi, std::uint64_t n) {
  using namespace render;
  const Vec3f mirror(-wi.x, -wi.y, wi.z);
  Samples result;
  for (std::uint64_t i = 0; i < n; ++i) {
    const VertexKey key = support::numbered(i, 2);
    const double x =
        sample_one_minus_cos(uniform(key, Dimension::kDirectionU), material.specular_exp);
    const Vec3f wo = around_axis(mirror, x, uniform(key, Dimension::kDirectionV));
    double value = 0.0;
    if (wo.z > 0.0F) {
      const double f = evaluate(support::bsdf_at(material, wo, model), wi).f_cos.x /
                       static_cast<double>(wi.z);
      value = f * static_cast<double>(wo.z) / cosine_power_pdf(x, material.specular_exp);
    }
    result.add(value);
  }
  return result;
}

inline std::string mode_name(const render::BsdfModel& model) { return name(model.light); }

}  // namespace raykiln::hard
