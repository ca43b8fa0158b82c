// The BSDF where every material is an opaque diffuse reflector: f = diffuse / pi on the side of wo.
// Values, directions and densities are those of Bsdf for such a material, bit for bit; what Bsdf
// computes for lobes that are not there is left out. In a header, so that loops over hits inline
// it.
#pragma once

#include <algorithm>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/bsdf.hpp"

namespace raykiln::render {

/// `kNormals`: shading normals may differ from those of the planes.
template <bool kNormals>
struct MatteBsdf {
  Vec3f ng{0.0F};  ///< geometric normal, on the side of wo
  Vec3f n{0.0F};   ///< shading normal, on the side of wo
  Rgbd diffuse{0.0};
  DiffuseSampling sampling = DiffuseSampling::kCosine;

  [[nodiscard]] Vec3d normal() const { return Vec3d(kNormals ? n : ng); }
};

/// Preconditions: specular and transparent are 0; directions are sampled by the BSDF; without
/// kNormals, ns is ng.
template <bool kNormals>
MatteBsdf<kNormals> make_matte_bsdf(const Material& material, const Vec3f& ng, const Vec3f& ns,
                                    const Vec3f& wo, const BsdfModel& model) {
  MatteBsdf<kNormals> b;
  b.ng = dot(Vec3d(ng), Vec3d(wo)) >= 0.0 ? ng : -ng;
  if constexpr (kNormals) {
    b.n = dot(ns, b.ng) < 0.0F ? -ns : ns;
    if (!(dot(Vec3d(b.n), Vec3d(wo)) > 0.0)) b.n = b.ng;
  }
  b.diffuse = Rgbd(material.diffuse) * (1.0 / kPi);
  b.sampling = model.light.diffuse_sampling;
  return b;
}

template <bool kNormals>
BsdfValue evaluate(const MatteBsdf<kNormals>& b, const Vec3f& wi) {
  if (!(dot(Vec3d(b.ng), Vec3d(wi)) > 0.0)) return {};
  const double cosine = std::clamp(dot(b.normal(), Vec3d(wi)), -1.0, 1.0);
  const double cos_i = std::max(cosine, 0.0);
  const double pdf =
      b.sampling == DiffuseSampling::kCosine ? cos_i / kPi : cosine_power_pdf(1.0 - cosine, 0.0);
  return {b.diffuse * cos_i, pdf};
}

template <bool kNormals>
BsdfSample sample_bsdf(const MatteBsdf<kNormals>& b, const DirectionNumbers& numbers) {
  const auto [lobe, side, u, v] = numbers;
  const double x = b.sampling == DiffuseSampling::kCosine ? sample_cosine_one_minus_cos(u)
                                                          : sample_one_minus_cos(u, 0.0);
  const Vec3f wi = around_axis(kNormals ? b.n : b.ng, x, v);
  const BsdfValue value = evaluate(b, wi);
  if (value.f_cos == Rgbd(0.0)) return {};
  return {.wi = wi, .weight = value.f_cos / value.pdf, .pdf = value.pdf, .lobe = Lobe::kDiffuse};
}

/// With dimensions kDirectionU and kDirectionV.
template <bool kNormals>
BsdfSample sample_bsdf(const MatteBsdf<kNormals>& b, const VertexKey& vertex) {
  return sample_bsdf(b, DirectionNumbers{.u = uniform(vertex, Dimension::kDirectionU),
                                         .v = uniform(vertex, Dimension::kDirectionV)});
}

}  // namespace raykiln::render
