#include "raykiln/shading/fresnel.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::render {

namespace {

/// Snell's law; the one place that decides total internal reflection, by sin^2 >= 1, never by
/// angles: asin(n) does not exist, and angles near 90 degrees have lost half of their digits.
FresnelTerm cross_border(double cos_from, double eta_from, double eta_to) {
  const double ratio = eta_from / eta_to;
  const double sin2_from = std::max((1.0 - cos_from) * (1.0 + cos_from), 0.0);
  const double sin2_to = ratio * ratio * sin2_from;
  if (!(sin2_to < 1.0)) return {.reflectance = 1.0, .cos_t = 0.0, .total_reflection = true};
  return {.reflectance = 0.0, .cos_t = std::sqrt(1.0 - sin2_to), .total_reflection = false};
}

}  // namespace

FresnelTerm fresnel_exact(double cos_from, double eta_from, double eta_to) {
  // 0/0 at grazing, and nothing to reflect at any angle.
  if (eta_from == eta_to) return {.reflectance = 0.0, .cos_t = cos_from, .total_reflection = false};
  FresnelTerm term = cross_border(cos_from, eta_from, eta_to);
  if (term.total_reflection) return term;
  const double s_from = eta_from * cos_from, s_to = eta_to * term.cos_t;
  const double p_from = eta_to * cos_from, p_to = eta_from * term.cos_t;
  const double rs = (s_from - s_to) / (s_from + s_to);
  const double rp = (p_from - p_to) / (p_from + p_to);
  term.reflectance = 0.5 * (rs * rs + rp * rp);
  return term;
}

FresnelTerm fresnel_schlick(double cos_from, double eta_from, double eta_to) {
  const FresnelTerm border = cross_border(cos_from, eta_from, eta_to);
  if (border.total_reflection) return border;
  const double cos_t = border.cos_t;
  const double root_r0 = (eta_from - eta_to) / (eta_from + eta_to);
  const double r0 = root_r0 * root_r0;
  const double rest = 1.0 - std::min(eta_from <= eta_to ? cos_from : cos_t, 1.0);
  const double rest2 = rest * rest;
  return {.reflectance = r0 + (1.0 - r0) * rest2 * rest2 * rest,
          .cos_t = cos_t,
          .total_reflection = false};
}

FresnelTerm fresnel_none(double cos_from, double eta_from, double eta_to) {
  if (eta_from == eta_to) return {.reflectance = 0.0, .cos_t = cos_from, .total_reflection = false};
  return cross_border(cos_from, eta_from, eta_to);
}

Vec3d refract(const Vec3d& w, const Vec3d& n, double cos_from, double cos_t, double eta_from,
              double eta_to) {
  const double ratio = eta_from / eta_to;
  return normalize(ratio * (cos_from * n - w) - cos_t * n);
}

}  // namespace raykiln::render
