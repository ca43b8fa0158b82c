// The BSDF of a material of either model.
#pragma once

#include <variant>

#include "raykiln/shading/bsdf.hpp"
#include "raykiln/shading/caster_cones.hpp"
#include "raykiln/shading/microfacet_bsdf.hpp"

namespace raykiln::render {

struct RichBsdf {
  Vec3f ng{0.0F};  ///< geometric normal, on the side of wo
  std::variant<Bsdf, MicrofacetBsdf> of;

  explicit RichBsdf(const Bsdf& phong) : ng(phong.ng), of(phong) {}
  explicit RichBsdf(const MicrofacetBsdf& facets) : ng(facets.ng), of(facets) {}
};

inline BsdfValue evaluate(const RichBsdf& bsdf, const Vec3f& wi) {
  return std::visit([&](const auto& b) { return evaluate(b, wi); }, bsdf.of);
}
inline BsdfSample sample_bsdf(const RichBsdf& bsdf, const VertexKey& vertex) {
  return std::visit([&](const auto& b) { return sample_bsdf(b, vertex); }, bsdf.of);
}

inline BsdfSample sample_bsdf(const RichBsdf& bsdf, const DirectionNumbers& numbers) {
  return std::visit([&](const auto& b) { return sample_bsdf(b, numbers); }, bsdf.of);
}
inline double diffuse_part(const MicrofacetBsdf& b) { return b.choice.diffuse + b.choice.diffuse_through; }
inline double diffuse_part(const RichBsdf& bsdf) {
  return std::visit([](const auto& b) { return diffuse_part(b); }, bsdf.of);
}

}  // namespace raykiln::render
