// Reflectance and refraction at the border of two transparent media.
#pragma once

#include "raykiln/math/vec.hpp"
#include "raykiln/shading/light_model.hpp"

namespace raykiln::render {

/// What a border does to light that meets it at some angle.
struct FresnelTerm {
  double reflectance = 1.0;  ///< in [0, 1]
  double cos_t = 0.0;        ///< cosine on the other side; 0 under total internal reflection
  bool total_reflection = false;
};

/// Fresnel's equations for light without polarisation, (r_s^2 + r_p^2)/2. `cos_from` in [0, 1] on the
/// side of index `eta_from`. Indices: positive, finite, at most the largest float. Equal indices
/// reflect nothing at any angle, also at grazing.
[[nodiscard]] FresnelTerm fresnel_exact(double cos_from, double eta_from, double eta_to);

/// Schlick (1994): R0 + (1 - R0)(1 - cos)^5 with the angle on the rare side, so that it reaches 1 at
/// the critical angle.
[[nodiscard]] FresnelTerm fresnel_schlick(double cos_from, double eta_from, double eta_to);

/// Total internal reflection alone. Equal indices reflect nothing at any angle.
[[nodiscard]] FresnelTerm fresnel_none(double cos_from, double eta_from, double eta_to);

[[nodiscard]] inline FresnelTerm fresnel(FresnelFormula formula, double cos_from, double eta_from,
                                         double eta_to) {
  if (formula == FresnelFormula::kExact) return fresnel_exact(cos_from, eta_from, eta_to);
  if (formula == FresnelFormula::kSchlick) return fresnel_schlick(cos_from, eta_from, eta_to);
  return fresnel_none(cos_from, eta_from, eta_to);
}

/// Direction on the other side of `n` (unit, on the side of `w`) for light leaving along `w`
/// (Snell's law). Precondition: no total reflection; `cos_t` from the same FresnelTerm.
[[nodiscard]] Vec3d refract(const Vec3d& w, const Vec3d& n, double cos_from, double cos_t,
                            double eta_from, double eta_to);

}  // namespace raykiln::render
