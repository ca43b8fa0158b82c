// The BSDF of a surface of microfacets, for one direction of view: glTF's metallic-roughness model with
// transmission, thin or as the border of a body.
#pragma once

#include "raykiln/shading/bsdf.hpp"

namespace raykiln::render {

/// Probabilities of what sampling picks; they sum to 1.
struct FacetChoice {
  double diffuse = 0.0;
  double repeated = 0.0;  ///< light that leaves after several reflections among facets
  double opaque = 0.0;    ///< one reflection at a facet
  double border = 0.0;    ///< one meeting with a facet of a clear border
  double diffuse_through = 0.0;  ///< diffusely to the far side
};

/// Everything that depends on the point and wo. With n turned to the side of wo, t = transparent,
/// E the albedo of facets that reflect everything and A that of the opaque share's:
///   f = (1 - t) [ F D G/(4 cos_i cos_o) + m(F) (1 - E_i)(1 - E_o)/(pi (1 - E_mean))
///                 + diffuse/pi (1 - A_i)(1 - A_o)/(1 - A_mean) ] + t f_border
/// on the side of wo; beyond it (1 - t) diffuse_through/pi (1 - A_i)(1 - A_o)/(1 - A_mean) + t f_border.
/// F is Schlick's from `specular` to `edge`. The second term is light
/// that met several facets (Kulla & Conty 2017); the third conserves energy below the first two
/// (Kelemen & Szirmay-Kalos 2001). All of that is reciprocal. f_border: see evaluate_border.
struct MicrofacetBsdf {
  BsdfModel model;
  Vec3f ng{0.0F};  ///< geometric normal, on the side of wo: decides sides
  Vec3f n{0.0F};   ///< shading normal, on the side of wo: gives cosines
  Vec3d wo{0.0}, z{0.0}, x{0.0}, y{0.0};  ///< the frame: z is n, wo lies in the plane of x and z
  double cos_o = 1.0, sin_o = 0.0, span_o = 1.0;
  double alpha = 1.0;
  Rgbd specular{0.0};  ///< at normal incidence
  double edge = 0.0;   ///< at grazing incidence
  Rgbd diffuse{0.0};   ///< albedo / pi times (1 - A_o)/(1 - A_mean)
  Rgbd diffuse_through{0.0};  ///< the same towards the far side
  Rgbd repeated{0.0};  ///< m(F) of the opaque share
  double lost_o = 0.0, lost_mean = 1.0;  ///< 1 - E
  double opaque_share = 1.0, border_share = 0.0;  ///< 1 - t and t
  bool thin = true;
  double eta_o = 1.0, eta_t = 1.0;  ///< of a body: on the side of wo, and beyond
  double radiance_scale = 1.0;      ///< of light refracted towards wo
  double kept = 1.0;                ///< of a body: what leaves its border after one meeting
  double mean_border = 0.0;         ///< of a sheet: its mean reflectance
  bool border_reflects = true;      ///< false: left out
  Rgbd tint{1.0};
  FacetChoice choice;
  bool black = true;
};

/// As make_bsdf. Precondition: material.model is kMicrofacet.
[[nodiscard]] MicrofacetBsdf make_microfacet_bsdf(const Material& material, const Vec3f& ng,
                                                  const Vec3f& ns, const Vec3f& wo,
                                                  const BsdfModel& model);

[[nodiscard]] BsdfValue evaluate(const MicrofacetBsdf& bsdf, const Vec3f& wi);
[[nodiscard]] BsdfSample sample_bsdf(const MicrofacetBsdf& bsdf, const DirectionNumbers& numbers);
[[nodiscard]] BsdfSample sample_bsdf(const MicrofacetBsdf& bsdf, const VertexKey& vertex);

/// Takes lobes out; sampling then picks among the rest.
struct FacetsLeftOut {
  bool diffuse = false, diffuse_through = false, reflection = false, transmission = false;
};
void leave_out(MicrofacetBsdf& bsdf, const FacetsLeftOut& lobes);

}  // namespace raykiln::render
