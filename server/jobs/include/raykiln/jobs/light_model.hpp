// Which formulas a job's light follows: a named model and what is switched against it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace raykiln::server {

enum class LightModel { kPhysical, kSeed };
enum class PhongDivisor { kMax, kOverCosO };
enum class FresnelFormula { kExact, kSchlick };
enum class DiffuseSampling { kCosine, kUniform };

/// Switches by themselves; unset: as the named model has them.
struct LightModelOverrides {
  std::optional<PhongDivisor> phong;
  std::optional<FresnelFormula> fresnel;
  std::optional<bool> radiance_scaling;  ///< refraction multiplies by the ratio of indices squared
  std::optional<DiffuseSampling> diffuse_sampling;
  std::optional<bool> roulette;          ///< ends paths at random instead of at a fixed depth

  friend bool operator==(const LightModelOverrides&, const LightModelOverrides&) = default;
};

[[nodiscard]] std::string_view name(LightModel value);
[[nodiscard]] std::string_view name(PhongDivisor value);
[[nodiscard]] std::string_view name(FresnelFormula value);
[[nodiscard]] std::string_view name(DiffuseSampling value);
[[nodiscard]] std::optional<LightModel> light_model_named(std::string_view name);
[[nodiscard]] std::optional<PhongDivisor> phong_divisor_named(std::string_view name);
[[nodiscard]] std::optional<FresnelFormula> fresnel_formula_named(std::string_view name);
[[nodiscard]] std::optional<DiffuseSampling> diffuse_sampling_named(std::string_view name);

/// What outputs are labelled with: "physical", "seed with radiance_scaling=true".
[[nodiscard]] std::string light_model_label(LightModel model, const LightModelOverrides& overrides);

/// The overrides as "phong=max,roulette=false", in this order of fields; "" for none.
[[nodiscard]] std::string overrides_text(const LightModelOverrides& overrides);
/// Reads that text again; nothing if a word is unknown. Later words win.
[[nodiscard]] std::optional<LightModelOverrides> overrides_of(std::string_view text);

}  // namespace raykiln::server
