// The BSDF at one point, for one direction of view: value, sampling and density.
#pragma once

#include <cstdint>
#include <optional>

#include "raykiln/math/vec.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/scene/scene.hpp"
#include "raykiln/shading/light_model.hpp"

namespace raykiln::render {

/// Uniform sphere is the reference estimator: slow, and hard to get wrong.
enum class DirectionSampling : std::uint8_t { kBsdf, kUniformSphere };

/// How values are computed and directions found.
struct BsdfModel {
  DirectionSampling direction_sampling = DirectionSampling::kBsdf;
  LightModel light;
};

/// Probabilities with which sampling picks a lobe; they sum to 1 unless all are 0.
struct LobeChoice {
  double specular = 0.0;           ///< else diffuse
  double diffuse_through = 0.0;    ///< of a diffuse pick: goes to the other side
  double specular_through = 0.0;   ///< of a specular pick: refracted
};

/// Share of the specular lobe in what sampling picks: by the largest channels, which permuting the
/// channels does not change. Nothing where both are black.
[[nodiscard]] std::optional<double> specular_share(const Rgb& diffuse, const Rgb& specular);

/// From here on a lobe is narrower than what a float direction can tell apart: a mirror, a clear border.
inline constexpr double kLargestExponent = 1e15;

/// Everything that depends on the point and wo. All vectors are unit and in world space.
struct Bsdf {
  BsdfModel model;
  Vec3f ng{0.0F};          ///< geometric normal, on the side of wo: decides sides
  Vec3f n{0.0F};           ///< shading normal, on the side of wo: gives cosines
  Vec3f mirror{0.0F};      ///< wo reflected about n
  Vec3f refracted{0.0F};   ///< wo refracted through n; meaningless under total reflection
  double cos_o = 1.0;      ///< n.wo > 0
  double cos_t = 0.0;      ///< cosine of `refracted`; 0 under total reflection
  double eta_o = 1.0, eta_t = 1.0;  ///< index on the side of wo and on the other
  double radiance_scale = 1.0;  ///< of light refracted towards wo: (eta_o/eta_t)^2, or 1 by the model
  double exponent = 1.0;
  Rgbd diffuse_same{0.0}, diffuse_through{0.0};        ///< values of f, sr^-1
  Rgbd specular_opaque{0.0}, specular_transparent{0.0};  ///< weights of f_ph and f_st
  LobeChoice choice;
  bool black = true;       ///< reflects and transmits nothing
};

/// The same for a material of transparent 0: no border, no far side. Members about them are unset.
/// Values, directions and densities are those of Bsdf, bit for bit.
struct OpaqueBsdf : Bsdf {};

/// f times |cos theta_i|, and the density over solid angle with which sample_bsdf finds wi.
struct BsdfValue {
  Rgbd f_cos{0.0};
  double pdf = 0.0;
};

enum class Lobe : std::uint8_t { kNone, kDiffuse, kSpecular };

struct BsdfSample {
  Vec3f wi{0.0F};
  Rgbd weight{0.0};       ///< f cos / pdf, finite for every exponent
  double pdf = 0.0;       ///< of the whole mixture, sr^-1
  Lobe lobe = Lobe::kNone;  ///< kNone: the path ends here
  double radiance_scale = 1.0;  ///< what of the weight is change of medium and not loss
};

/// `ng` as wound, `ns` interpolated (or ng); wo points away from the surface. Index 1 in front of
/// ng, the material's behind it. Where ns faces away from the viewer, ng takes its place.
[[nodiscard]] Bsdf make_bsdf(const Material& material, const Vec3f& ng, const Vec3f& ns,
                             const Vec3f& wo, const BsdfModel& model);

/// Precondition: material.transparent is 0.
[[nodiscard]] OpaqueBsdf make_opaque_bsdf(const Material& material, const Vec3f& ng,
                                          const Vec3f& ns, const Vec3f& wo, const BsdfModel& model);

/// True for mirrors and clear borders: evaluate() is 0 for all directions farther than kAxisWidth from `mirror`, or,
/// where there is a border, `refracted`.
[[nodiscard]] bool scatters_along_axes_alone(const Bsdf& bsdf);

/// Distance of two unit vectors. At kLargestExponent exp underflows from |a - b|^2 / 2 = 745 / 1e15 on, at a distance
/// of 1.3e-6; what rounding three floats moves a vector by, 1.1e-7, is well within the rest.
inline constexpr double kAxisWidth = 2e-6;

[[nodiscard]] BsdfValue evaluate(const Bsdf& bsdf, const Vec3f& wi);
[[nodiscard]] BsdfValue evaluate(const OpaqueBsdf& bsdf, const Vec3f& wi);

/// The numbers in [0, 1) that a direction takes.
struct DirectionNumbers {
  double lobe = 0.0, side = 0.0, u = 0.0, v = 0.0;
};
/// Dimensions kLobeChoice, kFresnelChoice, kDirectionU and kDirectionV of the vertex.
[[nodiscard]] DirectionNumbers direction_numbers(const VertexKey& vertex);

[[nodiscard]] BsdfSample sample_bsdf(const Bsdf& bsdf, const DirectionNumbers& numbers);
[[nodiscard]] BsdfSample sample_bsdf(const OpaqueBsdf& bsdf, const DirectionNumbers& numbers);

/// With the direction_numbers of the vertex.
[[nodiscard]] BsdfSample sample_bsdf(const Bsdf& bsdf, const VertexKey& vertex);
[[nodiscard]] BsdfSample sample_bsdf(const OpaqueBsdf& bsdf, const VertexKey& vertex);

}  // namespace raykiln::render
