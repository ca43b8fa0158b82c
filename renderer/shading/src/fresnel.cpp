#include "raykiln/shading/fresnel.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::render {

FresnelTerm fresnel_schlick(double cos_from, double eta_from, double eta_to) {
  const double ratio = eta_from / eta_to;
  const double sin2_from = std::max((1.0 - cos_from) * (1.0 + cos_from), 0.0);
  const double sin2_to = ratio * ratio * sin2_from;
  if (!(sin2_to < 1.0)) return {.reflectance = 1.0, .cos_t = 0.0, .total_reflection = true};
  const double cos_t = std::sqrt(1.0 - sin2_to);
  const double root_r0 = (eta_from - eta_to) / (eta_from + eta_to);
  const double r0 = root_r0 * root_r0;
  const double rest = 1.0 - std::min(eta_from <= eta_to ? cos_from : cos_t, 1.0);
  const double rest2 = rest * rest;
  return {.reflectance = r0 + (1.0 - r0) * rest2 * rest2 * rest,
          .cos_t = cos_t,
          .total_reflection = false};
}

Vec3d refract(const Vec3d& w, const Vec3d& n, double cos_from, double cos_t, double eta_from,
              double eta_to) {
  const double ratio = eta_from / eta_to;
  return normalize(ratio * (cos_from * n - w) - cos_t * n);
}

}  // namespace raykiln::render
