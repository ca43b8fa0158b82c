#include "raykiln/shading/microfacet_bsdf.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/facet_albedo.hpp"
#include "raykiln/shading/fresnel.hpp"
#include "raykiln/shading/ggx.hpp"

namespace raykiln::render {
namespace {

double largest(const Rgbd& c) { return std::max({c.x, c.y, c.z, 0.0}); }

/// 2 times the integral of Schlick's formula over cosine d cosine.
Rgbd mean_schlick(const Rgbd& normal, double edge) { return normal + (Rgbd(edge) - normal) / 21.0; }

/// Share of all that is lost after one reflection that comes back after more: each further meeting
/// reflects the mean of F and lets E_mean of that leave. 1 where F is 1.
Rgbd repeated_share(const Rgbd& mean_f, double lost_mean) {
  const double leaves = 1.0 - lost_mean;
  return mean_f * mean_f * leaves / (Rgbd(1.0) - mean_f * lost_mean);
}

/// Albedo of the reflecting part of the opaque share.
Rgbd albedo(const MicrofacetBsdf& b, const FacetAlbedo& facets) {
  return b.specular * (1.0 - facets.lost - facets.grazing) + Rgbd(b.edge * facets.grazing) +
         b.repeated * facets.lost;
}

/// One direction beside wo, and the facet between them.
struct Meeting {
  double cos_i = 0.0;   ///< > 0 on its own side
  double span_i = 1.0;
  double cos_h = 1.0;   ///< of wo and the facet
  double density = 0.0; ///< of visible facets, over the solid angle of their normals, less cos_h
};

Meeting meet(const MicrofacetBsdf& b, double cos_i, double cos_h, double sin2, double cos2) {
  return {.cos_i = cos_i,
          .span_i = ggx_span(cos_i, b.alpha),
          .cos_h = cos_h,
          .density = ggx_density(sin2, cos2, b.alpha) * 2.0 / (b.cos_o + b.span_o)};
}

double passes(const MicrofacetBsdf& b, const Meeting& m) {
  return ggx_passes(b.cos_o, b.span_o, m.cos_i, m.span_i);
}

FresnelTerm border_term(const MicrofacetBsdf& b, double cos_h) {
  return fresnel(b.model.light.fresnel, std::min(cos_h, 1.0), b.eta_o, b.eta_t);
}

/// Light that met several facets of the sheet or the opaque share, towards cosine cos_i: (1 - E_i)(1 - E_o)
/// cos_i/(pi (1 - E_mean)), without its colour.
double repeated_lobe(const MicrofacetBsdf& b, double cos_i, double lost_i) {
  return b.lost_o * lost_i * cos_i / (kPi * b.lost_mean);
}

// Reflection: opaque share, sheet, and the border of a body.
BsdfValue evaluate_same_side(const MicrofacetBsdf& b, const Meeting& m) {
  const FacetAlbedo facets = FacetAlbedoTables::get().at(std::min(m.cos_i, 1.0), b.alpha);
  const double mirrored = 0.25 * m.density, single = mirrored * passes(b, m);
  const double repeated = repeated_lobe(b, m.cos_i, facets.lost);
  BsdfValue value;
  if (b.opaque_share > 0.0) {
    const double c = std::max(1.0 - m.cos_h, 0.0), c5 = c * c * c * c * c;
    const Rgbd f = b.specular + (Rgbd(b.edge) - b.specular) * c5;
    value.f_cos += b.opaque_share * (f * single + b.repeated * repeated +
                                     b.diffuse * (Rgbd(1.0) - albedo(b, facets)) * m.cos_i);
  }
  double meets = b.choice.opaque, again = b.choice.repeated;
  if (b.border_share > 0.0) {
    const double f = border_term(b, m.cos_h).reflectance;
    if (b.border_reflects) {
      value.f_cos += Rgbd(b.border_share * (f * single / b.kept));
      if (b.thin) value.f_cos += Rgbd(b.border_share * b.mean_border * repeated);
    }
    meets += b.choice.border * f;
    if (b.thin) again *= 1.0 - b.border_share * (1.0 - b.mean_border) / (b.border_share + b.opaque_share);
  }
  value.pdf = b.choice.diffuse * m.cos_i / kPi + meets * mirrored;
  if (again > 0.0) value.pdf += again * LostDirections(b.alpha).pdf(m.cos_i);
  return value;
}

/// Beyond a sheet: what it would reflect, mirrored at its plane.
BsdfValue evaluate_behind_sheet(const MicrofacetBsdf& b, const Meeting& m) {
  const double f = border_term(b, m.cos_h).reflectance;
  const double lost_i = FacetAlbedoTables::get().at(std::min(m.cos_i, 1.0), b.alpha).lost;
  const double mirrored = 0.25 * m.density;
  BsdfValue value;
  value.f_cos = b.border_share * b.tint * ((1.0 - f) * mirrored * passes(b, m) +
                                           (1.0 - b.mean_border) * repeated_lobe(b, m.cos_i, lost_i));
  value.pdf = b.choice.border * (1.0 - f) * mirrored;
  const double again = b.choice.repeated * b.border_share * (1.0 - b.mean_border) /
                       (b.border_share + b.opaque_share);
  if (again > 0.0) value.pdf += again * LostDirections(b.alpha).pdf(m.cos_i);
  return value;
}

/// Beyond the border of a body (Walter et al. 2007, equations 17 and 21). `cos_t` > 0 is that of the
/// refracted direction with the facet.
BsdfValue evaluate_refraction(const MicrofacetBsdf& b, const Meeting& m, double cos_t) {
  const double f = border_term(b, m.cos_h).reflectance;
  const double reach = b.eta_o * m.cos_h - b.eta_t * cos_t;
  const double pdf = m.density * m.cos_h * b.eta_t * b.eta_t * cos_t / (reach * reach);
  const double share = b.border_share * (1.0 - f) / b.kept * b.radiance_scale;
  return {b.tint * (share * pdf * passes(b, m)), b.choice.border * (1.0 - f) * pdf};
}

struct Facet {
  double cos_h, sin2, cos2, up;  ///< up: sign of its cosine with z
};

Facet facet_of(const MicrofacetBsdf& b, const Vec3d& h) {
  const double up = dot(h, b.z);
  const Vec3d across = h - up * b.z;
  return {dot(h, b.wo), dot(across, across), up * up, up};
}

/// Light that comes diffusely through the base: as what the base reflects, it passes the facets on its
/// way out by 1 - A_o, and on its way in by 1 - A_i.
BsdfValue evaluate_diffuse_through(const MicrofacetBsdf& b, double cos_i) {
  if (!(b.choice.diffuse_through > 0.0)) return {};
  const FacetAlbedo facets = FacetAlbedoTables::get().at(std::min(cos_i, 1.0), b.alpha);
  return {b.opaque_share * b.diffuse_through * (Rgbd(1.0) - albedo(b, facets)) * cos_i,
          b.choice.diffuse_through * cos_i / kPi};
}

BsdfValue sum_of(const BsdfValue& a, const BsdfValue& b) {
  return {a.f_cos + b.f_cos, a.pdf + b.pdf};
}

BsdfValue evaluate_border(const MicrofacetBsdf& b, const Vec3d& wi, double cos_i) {
  if (!(b.border_share > 0.0 && b.choice.border > 0.0)) return {};
  if (b.thin) {
    const Facet h = facet_of(b, normalize(b.wo + wi + 2.0 * cos_i * b.z));
    return evaluate_behind_sheet(b, meet(b, cos_i, h.cos_h, h.sin2, h.cos2));
  }
  const Vec3d sum = b.eta_o * b.wo + b.eta_t * wi;
  const double size = length(sum);
  if (!(size > 0.0)) return {};
  const Vec3d outwards = b.eta_t > b.eta_o ? -sum / size : sum / size;
  const Facet h = facet_of(b, outwards);
  const double cos_t = -dot(outwards, wi);
  if (!(h.up > 0.0 && h.cos_h > 0.0 && cos_t > 0.0)) return {};
  return evaluate_refraction(b, meet(b, cos_i, h.cos_h, h.sin2, h.cos2), cos_t);
}

BsdfValue evaluate_far_side(const MicrofacetBsdf& b, const Vec3d& wi, double cos_i) {
  return sum_of(evaluate_border(b, wi, cos_i), evaluate_diffuse_through(b, cos_i));
}

/// Picks again among what is left.
void choose(MicrofacetBsdf& b) {
  const FacetAlbedo facets = FacetAlbedoTables::get().at(b.cos_o, b.alpha);
  FacetChoice c;
  c.diffuse = b.opaque_share * kPi * largest(b.diffuse);
  c.opaque = b.opaque_share * largest(b.specular * (1.0 - facets.lost - facets.grazing) +
                                      Rgbd(b.edge * facets.grazing));
  c.border = b.border_share;
  c.repeated = b.lost_o * (b.opaque_share * largest(b.repeated) + (b.thin ? b.border_share : 0.0));
  c.diffuse_through = b.opaque_share * kPi * largest(b.diffuse_through);
  const double sum = c.diffuse + c.opaque + c.border + c.repeated + c.diffuse_through;
  b.black = !(sum > 0.0);
  const double scale = sum > 0.0 ? 1.0 / sum : 0.0;
  b.choice = {c.diffuse * scale, c.repeated * scale, c.opaque * scale, c.border * scale, c.diffuse_through * scale};
}

void set_frame(MicrofacetBsdf& b, const Vec3f& ng, const Vec3f& ns, const Vec3f& wo) {
  b.ng = dot(Vec3d(ng), Vec3d(wo)) >= 0.0 ? ng : -ng;
  b.n = dot(ns, b.ng) < 0.0F ? -ns : ns;
  if (!(dot(Vec3d(b.n), Vec3d(wo)) > 0.0)) b.n = b.ng;
  b.wo = normalize(Vec3d(wo));
  b.z = normalize(Vec3d(b.n));
  b.cos_o = std::clamp(dot(b.z, b.wo), 0.0, 1.0);
  const Vec3d along = b.wo - b.cos_o * b.z;
  b.sin_o = length(along);
  const Vec3d other = std::abs(b.z.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  b.x = b.sin_o > 0.0 ? along / b.sin_o : normalize(cross(other, b.z));
  b.y = cross(b.z, b.x);
}

void set_border(MicrofacetBsdf& b, const Material& material, bool front) {
  const auto index = static_cast<double>(material.index_of_refraction);
  // A border between equal media, however rough, bends nothing: a sheet that reflects nothing.
  b.thin = material.facets.thin || index == 1.0;
  if (index == 1.0 && b.opaque_share == 0.0) b.alpha = kLeastAlpha;
  b.eta_o = b.thin || front ? 1.0 : index;
  b.eta_t = b.thin || front ? index : 1.0;
  b.tint = Rgbd(material.facets.tint);
  const double root = (index - 1.0) / (index + 1.0);
  b.mean_border = mean_schlick(Rgbd(root * root), 1.0).x;
}

void set_energy(MicrofacetBsdf& b, const Material& material) {
  const FacetAlbedoTables& tables = FacetAlbedoTables::get();
  const FacetAlbedo here = tables.at(b.cos_o, b.alpha), mean = tables.mean(b.alpha);
  b.lost_o = here.lost;
  b.lost_mean = mean.lost;
  b.repeated = repeated_share(mean_schlick(b.specular, b.edge), mean.lost);
  const Rgbd below = Rgbd(1.0) - albedo(b, mean);
  const auto base = [&](const Rgb& colour, Rgbd& lobe) {
    for (int c = 0; c < 3; ++c) {
      const auto albedo_c = static_cast<double>(colour[c]);
      if (!(albedo_c > 0.0 && below[c] > 1e-9)) continue;
      lobe[c] = albedo_c / kPi * std::max(1.0 - albedo(b, here)[c], 0.0) / below[c];
    }
  };
  base(material.diffuse, b.diffuse);
  base(material.facets.diffuse_through, b.diffuse_through);
  if (b.border_share > 0.0 && !b.thin) b.kept = border_albedo(b.cos_o, b.alpha, b.eta_t / b.eta_o);
  if (!b.thin && b.model.light.radiance_scaling) {
    const double ratio = b.eta_o / b.eta_t;
    b.radiance_scale = ratio * ratio;
  }
}

BsdfSample finished(const MicrofacetBsdf& b, const Vec3f& wi, Lobe lobe, const BsdfValue& value) {
  if (value.f_cos == Rgbd(0.0) || !(value.pdf > 0.0)) return {};
  const bool through = dot(Vec3d(b.ng), Vec3d(wi)) < 0.0;
  return {.wi = wi,
          .weight = value.f_cos / value.pdf,
          .pdf = value.pdf,
          .lobe = lobe,
          .radiance_scale = through && !b.thin && b.border_share > 0.0 ? b.radiance_scale : 1.0};
}

bool on_side(const MicrofacetBsdf& b, const Vec3f& wi, bool through) {
  const double side = dot(Vec3d(b.ng), Vec3d(wi));
  return through ? side < 0.0 : side > 0.0;
}

/// Light from a facet: the value comes from the facet that was drawn, not from rounded directions.
BsdfSample sample_facet(const MicrofacetBsdf& b, double u, double v, double side, bool clear) {
  const Vec3d wo(b.sin_o, 0.0, b.cos_o);
  const Vec3d h = ggx_visible_normal(wo, b.alpha, u, v);
  const double cos_h = std::min(dot(wo, h), 1.0);
  if (!(cos_h > 0.0)) return {};
  const FresnelTerm term = clear ? border_term(b, cos_h) : FresnelTerm{};
  const bool through = clear && side >= term.reflectance;
  Vec3d wi = through && !b.thin ? refract(wo, h, cos_h, term.cos_t, b.eta_o, b.eta_t)
                                : 2.0 * cos_h * h - wo;
  if (through && b.thin) wi.z = -wi.z;
  const double cos_i = through ? -wi.z : wi.z;
  if (!(cos_i > 0.0)) return {};
  const Vec3f world(wi.x * b.x + wi.y * b.y + wi.z * b.z);
  if (!on_side(b, world, through)) return {};
  const Meeting m = meet(b, std::min(cos_i, 1.0), cos_h, h.x * h.x + h.y * h.y, h.z * h.z);
  BsdfValue value = !through  ? evaluate_same_side(b, m)
                    : b.thin ? evaluate_behind_sheet(b, m)
                             : evaluate_refraction(b, m, term.cos_t);
  if (through) value = sum_of(value, evaluate_diffuse_through(b, m.cos_i));
  return finished(b, world, Lobe::kSpecular, value);
}

BsdfSample sample_about(const MicrofacetBsdf& b, double one_minus_cos, double v, bool through, Lobe lobe) {
  const Vec3f wi = around_axis(through ? -b.n : b.n, one_minus_cos, v);
  if (!on_side(b, wi, through)) return {};
  return finished(b, wi, lobe, evaluate(b, wi));
}

}  // namespace

MicrofacetBsdf make_microfacet_bsdf(const Material& material, const Vec3f& ng, const Vec3f& ns,
                                    const Vec3f& wo, const BsdfModel& model) {
  MicrofacetBsdf b;
  b.model = model;
  set_frame(b, ng, ns, wo);
  b.alpha = ggx_alpha(material.facets.roughness);
  b.border_share = static_cast<double>(material.transparent);
  b.opaque_share = 1.0 - b.border_share;
  b.specular = Rgbd(material.specular);
  b.edge = static_cast<double>(material.facets.edge);
  set_border(b, material, dot(Vec3d(ng), Vec3d(wo)) >= 0.0);
  b.span_o = ggx_span(b.cos_o, b.alpha);
  set_energy(b, material);
  choose(b);
  return b;
}

BsdfValue evaluate(const MicrofacetBsdf& b, const Vec3f& wi) {
  if (b.black) return {};
  const double side = dot(Vec3d(b.ng), Vec3d(wi));
  const Vec3d w = normalize(Vec3d(wi));
  const double cosine = side > 0.0 ? dot(b.z, w) : -dot(b.z, w);
  if (side == 0.0 || !(cosine > 0.0)) return {};
  const double cos_i = std::min(cosine, 1.0);
  BsdfValue value;
  if (side > 0.0) {
    const Facet h = facet_of(b, normalize(b.wo + w));
    value = evaluate_same_side(b, meet(b, cos_i, h.cos_h, h.sin2, h.cos2));
  } else {
    value = evaluate_far_side(b, w, cos_i);
  }
  if (b.model.direction_sampling == DirectionSampling::kUniformSphere) {
    value.pdf = kUniformSpherePdf;
  }
  return value;
}

BsdfSample sample_bsdf(const MicrofacetBsdf& b, const DirectionNumbers& numbers) {
  if (b.black) return {};
  double left = numbers.lobe;
  const auto picks = [&left](double probability) {
    left -= probability;
    return left < 0.0;
  };
  const auto [lobe, side, u, v] = numbers;
  if (b.model.direction_sampling == DirectionSampling::kUniformSphere) {
    const Vec3f wi = sample_uniform_sphere(u, v);
    return finished(b, wi, Lobe::kDiffuse, evaluate(b, wi));
  }
  if (picks(b.choice.diffuse)) {
    return sample_about(b, sample_cosine_one_minus_cos(u), v, false, Lobe::kDiffuse);
  }
  if (picks(b.choice.diffuse_through)) {
    return sample_about(b, sample_cosine_one_minus_cos(u), v, true, Lobe::kDiffuse);
  }
  if (picks(b.choice.repeated)) {
    const double beyond = b.thin ? b.border_share * (1.0 - b.mean_border) : 0.0;
    const bool through = side * (b.border_share + b.opaque_share) < beyond;
    return sample_about(b, 1.0 - LostDirections(b.alpha).sample_cosine(u), v, through, Lobe::kSpecular);
  }
  const bool clear = b.choice.border > 0.0 && !picks(b.choice.opaque);
  return sample_facet(b, u, v, side, clear);
}

BsdfSample sample_bsdf(const MicrofacetBsdf& b, const VertexKey& vertex) {
  return sample_bsdf(b, direction_numbers(vertex));
}

void leave_out(MicrofacetBsdf& b, const FacetsLeftOut& lobes) {
  if (lobes.diffuse) b.diffuse = Rgbd(0.0);
  if (lobes.diffuse_through) b.diffuse_through = Rgbd(0.0);
  if (lobes.reflection) {
    b.specular = b.repeated = Rgbd(0.0);
    b.edge = 0.0;
    b.border_reflects = false;
  }
  if (lobes.transmission) b.tint = Rgbd(0.0);
  choose(b);
}

}  // namespace raykiln::render
