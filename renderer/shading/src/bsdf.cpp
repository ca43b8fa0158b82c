#include "raykiln/shading/bsdf.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/fresnel.hpp"

namespace raykiln::render {
namespace {

/// Whether there may be a border and a far side; false is OpaqueBsdf.
enum class Sides : bool { kNear, kBoth };

double largest(const Rgb& c) { return static_cast<double>(std::max({c.x, c.y, c.z, 0.0F})); }

/// Broad lobes mix directions of view with other reflectances than that of wo, so a choice that
/// follows F(theta_o) to 0 would leave weights F(theta_i) / F(theta_o) without bound.
constexpr double kBroadExponent = 1e4;
constexpr double kLeastShare = 1.0 / 32.0;

double reflected_share(const FresnelTerm& fresnel, double exponent) {
  if (fresnel.total_reflection || exponent >= kBroadExponent) return fresnel.reflectance;
  return std::clamp(fresnel.reflectance, kLeastShare, 1.0 - kLeastShare);
}

LobeChoice choose_lobes(const Material& material, double share) {
  const double transparent = static_cast<double>(material.transparent);
  LobeChoice choice;
  choice.specular = specular_share(material.diffuse, material.specular).value_or(0.0);
  choice.diffuse_through = 0.5 * transparent;
  choice.specular_through = transparent * (1.0 - share);
  return choice;
}

/// What a Phong lobe is divided by; `cos_axis` is that of the side's undisturbed direction.
double phong_divisor(const Bsdf& b, double cos_i, double cos_axis) {
  return b.model.light.phong == PhongCosine::kMax ? std::max(cos_i, cos_axis) : cos_axis;
}

/// Density of diffuse directions at this cosine with the normal, which may be negative.
double diffuse_pdf(const Bsdf& b, double cosine) {
  return b.model.light.diffuse_sampling == DiffuseSampling::kCosine
             ? std::max(cosine, 0.0) / kPi
             : cosine_power_pdf(1.0 - cosine, 0.0);
}

/// Value on the side of wo: diffuse + (opaque + transparent F(theta_i)) f_ph, f_ph over cos_o or
/// max(cos_i, cos_o). `cosine` is n.wi.
template <Sides kSides>
BsdfValue evaluate_same_side(const Bsdf& b, double cosine, double x_specular) {
  const double cos_i = std::max(cosine, 0.0);
  const double lobe = b.choice.specular > 0.0 ? cosine_power_pdf(x_specular, b.exponent) : 0.0;
  Rgbd f = b.diffuse_same;
  if (lobe > 0.0) {
    Rgbd specular = b.specular_opaque;
    if constexpr (kSides == Sides::kBoth) {
      specular += b.specular_transparent *
                  fresnel(b.model.light.fresnel, cos_i, b.eta_o, b.eta_t).reflectance;
    }
    f += specular * (lobe / phong_divisor(b, cos_i, b.cos_o));
  }
  const double diffuse =
      (1.0 - b.choice.specular) * (1.0 - b.choice.diffuse_through) * diffuse_pdf(b, cosine);
  return {f * cos_i, diffuse + b.choice.specular * (1.0 - b.choice.specular_through) * lobe};
}

/// Value on the other side: diffuse + transparent (1 - F(theta_i)) f_ph(wi, refract(wo)), the
/// latter scaled by the change of medium. `cosine` is -n.wi.
BsdfValue evaluate_other_side(const Bsdf& b, double cosine, double x_specular) {
  const double cos_i = std::max(cosine, 0.0);
  const bool refracts = b.choice.specular * b.choice.specular_through > 0.0 && b.cos_t > 0.0;
  const double lobe = refracts ? cosine_power_pdf(x_specular, b.exponent) : 0.0;
  Rgbd f = b.diffuse_through;
  if (lobe > 0.0) {
    const double reflectance = fresnel(b.model.light.fresnel, cos_i, b.eta_t, b.eta_o).reflectance;
    f += b.specular_transparent *
         (b.radiance_scale * ((1.0 - reflectance) * lobe / phong_divisor(b, cos_i, b.cos_t)));
  }
  const double diffuse =
      (1.0 - b.choice.specular) * b.choice.diffuse_through * diffuse_pdf(b, cosine);
  return {f * cos_i, diffuse + b.choice.specular * b.choice.specular_through * lobe};
}

/// What is known of a direction beside its rounded components.
struct KnownDirection {
  double x = -1.0;       ///< exact 1 - cos to the axis of the lobe; negative: it is measured
  double cosine = -2.0;  ///< exact cosine with n; below -1: it is measured
};

template <Sides kSides>
BsdfValue evaluate_with(const Bsdf& b, const Vec3f& wi, const KnownDirection& known) {
  if (b.black) return {};
  const double side = dot(Vec3d(b.ng), Vec3d(wi));
  if constexpr (kSides == Sides::kNear) {
    const bool far = side <= 0.0 && b.model.direction_sampling == DirectionSampling::kBsdf;
    if (far) return {};
  }
  const double cosine =
      known.cosine >= -1.0 ? known.cosine : std::clamp(dot(Vec3d(b.n), Vec3d(wi)), -1.0, 1.0);
  const Vec3f& axis = side > 0.0 ? b.mirror : b.refracted;
  const double x = known.x >= 0.0 ? known.x : one_minus_cos(axis, wi);
  BsdfValue value;
  if (side > 0.0) {
    value = evaluate_same_side<kSides>(b, cosine, x);
  } else if (kSides == Sides::kBoth && side < 0.0) {
    value = evaluate_other_side(b, -cosine, x);
  }
  if (b.model.direction_sampling == DirectionSampling::kUniformSphere) {
    value.pdf = kUniformSpherePdf;
  }
  return value;
}

template <Sides kSides>
BsdfSample finish(const Bsdf& b, const Vec3f& wi, Lobe lobe, bool through,
                  const KnownDirection& known) {
  // The part of a lobe that reaches beyond its own side of the surface is lost, not reflected.
  const double side = dot(Vec3d(b.ng), Vec3d(wi));
  if (lobe != Lobe::kNone && (through ? side >= 0.0 : side <= 0.0)) return {};
  const BsdfValue value = evaluate_with<kSides>(b, wi, known);
  if (value.f_cos == Rgbd(0.0)) return {};
  return {.wi = wi,
          .weight = value.f_cos / value.pdf,
          .pdf = value.pdf,
          .lobe = lobe,
          .radiance_scale = lobe == Lobe::kSpecular && through ? b.radiance_scale : 1.0};
}

/// A lobe narrower than a float direction can tell is its axis, and the angle of that with n is known:
/// measured on rounded directions, cos_i and cos_o would differ by 1e-7 tan(theta), and a mirror or
/// a clear pane would take that much of the light.
template <Sides kSides>
BsdfSample axis_itself(const Bsdf& b, bool through) {
  return finish<kSides>(b, through ? b.refracted : b.mirror, Lobe::kSpecular, through,
                        {.x = 0.0, .cosine = through ? -b.cos_t : b.cos_o});
}

/// What differs with the direction of view at a border; the rest of Bsdf is set.
void cross_border(Bsdf& b, const Material& material, const Vec3f& wo) {
  const FresnelTerm border = fresnel(b.model.light.fresnel, b.cos_o, b.eta_o, b.eta_t);
  b.cos_t = border.cos_t;
  if (!border.total_reflection) {
    b.refracted = Vec3f(refract(Vec3d(wo), Vec3d(b.n), b.cos_o, b.cos_t, b.eta_o, b.eta_t));
  }
  if (b.model.light.radiance_scaling) {
    const double ratio = b.eta_o / b.eta_t;
    b.radiance_scale = ratio * ratio;
  }
  b.choice = choose_lobes(material, reflected_share(border, b.exponent));
}

template <Sides kSides>
void make(Bsdf& b, const Material& material, const Vec3f& ng, const Vec3f& ns, const Vec3f& wo,
          const BsdfModel& model) {
  b.model = model;
  const bool front = dot(Vec3d(ng), Vec3d(wo)) >= 0.0;
  b.ng = front ? ng : -ng;
  b.n = dot(ns, b.ng) < 0.0F ? -ns : ns;
  b.cos_o = std::min(dot(Vec3d(b.n), Vec3d(wo)), 1.0);
  if (!(b.cos_o > 0.0)) {
    b.n = b.ng;
    b.cos_o = std::clamp(dot(Vec3d(b.n), Vec3d(wo)), 0x1p-100, 1.0);
  }
  b.eta_o = front ? 1.0 : static_cast<double>(material.index_of_refraction);
  b.eta_t = front ? static_cast<double>(material.index_of_refraction) : 1.0;
  b.exponent = std::min(material.specular_exp, kLargestExponent);

  const double transparent = static_cast<double>(material.transparent);
  const Rgbd diffuse(material.diffuse);
  b.diffuse_same = diffuse * ((1.0 - 0.5 * transparent) / kPi);
  b.diffuse_through = diffuse * (0.5 * transparent / kPi);
  b.specular_opaque = Rgbd(material.specular) * (1.0 - transparent);
  b.specular_transparent = Rgbd(material.specular) * transparent;
  b.black = !specular_share(material.diffuse, material.specular);

  const Vec3d n(b.n), w(wo);
  b.mirror = Vec3f(normalize(2.0 * b.cos_o * n - w));
  if constexpr (kSides == Sides::kBoth) {
    cross_border(b, material, wo);
  } else {
    b.choice = choose_lobes(material, 1.0);
  }
}

/// The numbers of a vertex as they are asked for: a mirror asks for none, a clear border for one.
struct NumbersOnDemand {
  const VertexKey& vertex;
  [[nodiscard]] double lobe() const { return uniform(vertex, Dimension::kLobeChoice); }
  [[nodiscard]] double side() const { return uniform(vertex, Dimension::kFresnelChoice); }
  [[nodiscard]] double u() const { return uniform(vertex, Dimension::kDirectionU); }
  [[nodiscard]] double v() const { return uniform(vertex, Dimension::kDirectionV); }
};
struct GivenNumbers {
  const DirectionNumbers& numbers;
  [[nodiscard]] double lobe() const { return numbers.lobe; }
  [[nodiscard]] double side() const { return numbers.side; }
  [[nodiscard]] double u() const { return numbers.u; }
  [[nodiscard]] double v() const { return numbers.v; }
};

/// Is a number of [0, 1) below this share? It is drawn only where that is open.
template <class Draw>
bool falls_below(double share, const Draw& draw) {
  return share >= 1.0 || (share > 0.0 && draw() < share);
}

template <Sides kSides, class Numbers>
BsdfSample sample(const Bsdf& b, const Numbers& numbers) {
  if (b.black) return {};
  if (b.model.direction_sampling == DirectionSampling::kUniformSphere) {
    BsdfSample found = finish<kSides>(b, sample_uniform_sphere(numbers.u(), numbers.v()), Lobe::kNone, false, {});
    if (found.pdf > 0.0) found.lobe = Lobe::kDiffuse;
    return found;
  }
  const bool specular = falls_below(b.choice.specular, [&] { return numbers.lobe(); });
  const double through_share = specular ? b.choice.specular_through : b.choice.diffuse_through;
  const bool through = falls_below(through_share, [&] { return numbers.side(); });
  if (specular && b.exponent >= kLargestExponent) return axis_itself<kSides>(b, through);
  const double u = numbers.u(), v = numbers.v();
  if (specular) {
    const double x = sample_one_minus_cos(u, b.exponent);
    return finish<kSides>(b, around_axis(through ? b.refracted : b.mirror, x, v), Lobe::kSpecular,
                          through, {.x = x});
  }
  const double x = b.model.light.diffuse_sampling == DiffuseSampling::kCosine
                       ? sample_cosine_one_minus_cos(u)
                       : sample_one_minus_cos(u, 0.0);
  return finish<kSides>(b, around_axis(through ? -b.n : b.n, x, v), Lobe::kDiffuse, through, {});
}

}  // namespace

DirectionNumbers direction_numbers(const VertexKey& vertex) {
  return {.lobe = uniform(vertex, Dimension::kLobeChoice),
          .side = uniform(vertex, Dimension::kFresnelChoice),
          .u = uniform(vertex, Dimension::kDirectionU),
          .v = uniform(vertex, Dimension::kDirectionV)};
}

std::optional<double> specular_share(const Rgb& diffuse, const Rgb& specular) {
  const double d = largest(diffuse), s = largest(specular);
  if (!(d + s > 0.0)) return std::nullopt;
  return s / (d + s);
}

Bsdf make_bsdf(const Material& material, const Vec3f& ng, const Vec3f& ns, const Vec3f& wo,
               const BsdfModel& model) {
  Bsdf b;
  make<Sides::kBoth>(b, material, ng, ns, wo, model);
  return b;
}

OpaqueBsdf make_opaque_bsdf(const Material& material, const Vec3f& ng, const Vec3f& ns,
                            const Vec3f& wo, const BsdfModel& model) {
  OpaqueBsdf b;
  make<Sides::kNear>(b, material, ng, ns, wo, model);
  return b;
}

bool scatters_along_axes_alone(const Bsdf& b) {
  return b.exponent >= kLargestExponent && b.diffuse_same == Rgbd(0.0) && b.diffuse_through == Rgbd(0.0);
}

BsdfValue evaluate(const Bsdf& b, const Vec3f& wi) {
  return evaluate_with<Sides::kBoth>(b, wi, {});
}
BsdfValue evaluate(const OpaqueBsdf& b, const Vec3f& wi) {
  return evaluate_with<Sides::kNear>(b, wi, {});
}

BsdfSample sample_bsdf(const Bsdf& b, const DirectionNumbers& numbers) {
  return sample<Sides::kBoth>(b, GivenNumbers{numbers});
}
BsdfSample sample_bsdf(const OpaqueBsdf& b, const DirectionNumbers& numbers) {
  return sample<Sides::kNear>(b, GivenNumbers{numbers});
}
BsdfSample sample_bsdf(const Bsdf& b, const VertexKey& vertex) {
  return sample<Sides::kBoth>(b, NumbersOnDemand{vertex});
}
BsdfSample sample_bsdf(const OpaqueBsdf& b, const VertexKey& vertex) {
  return sample<Sides::kNear>(b, NumbersOnDemand{vertex});
}

}  // namespace raykiln::render
