// Which formulas light follows: two models with a name, and every switch between them by itself.
#pragma once

#include <cstdint>
#include <string>

namespace raykiln::render {

/// What the Phong lobe (e + 1)/(2 pi) cos^e(alpha) is divided by.
enum class PhongCosine : std::uint8_t {
  kMax,       ///< max(cos_i, cos_o): reciprocal, weights at most 1 (Neumann et al. 1999)
  kOverCosO,  ///< cos_o, as the seed has it: the share of the lobe above the horizon is kept, but
              ///< weights cos_i/cos_o have no finite variance near grazing views
};

/// Reflectance of a border between two media, for light without polarisation.
enum class FresnelFormula : std::uint8_t {
  kExact,
  kSchlick,
  kNone,  ///< 0 below the critical angle: an approximation that no model has by itself
};

/// Density of diffuse directions about the normal; the estimate is the same, its noise is not.
enum class DiffuseSampling : std::uint8_t { kCosine, kUniform };

/// All switches. The default is the physical model.
struct LightModel {
  PhongCosine phong = PhongCosine::kMax;
  FresnelFormula fresnel = FresnelFormula::kExact;
  /// Radiance is multiplied by (eta_o/eta_i)^2 where light goes from index eta_i to eta_o: radiance
  /// over eta^2 is what a border conserves. Without it light that leaves glass gains eta^2.
  bool radiance_scaling = true;
  DiffuseSampling diffuse_sampling = DiffuseSampling::kCosine;
  /// Ends paths at random, without bias, instead of at a fixed depth.
  bool roulette = true;

  friend bool operator==(const LightModel&, const LightModel&) = default;
};

/// Paths that a limit ends after so many reflections at most are left alone by roulette.
inline constexpr int kBouncesBeforeRoulette = 3;

inline constexpr LightModel kPhysicalModel{};
/// The formulas of the seed's own text.
inline constexpr LightModel kSeedModel{.phong = PhongCosine::kOverCosO,
                                       .fresnel = FresnelFormula::kSchlick,
                                       .radiance_scaling = false,
                                       .diffuse_sampling = DiffuseSampling::kUniform,
                                       .roulette = false};

/// "physical", "seed", or the nearer of them with what differs: "physical with
/// phong=over_cos_o,roulette=false". Equal models have equal names, others differ.
[[nodiscard]] std::string name(const LightModel& model);

}  // namespace raykiln::render
