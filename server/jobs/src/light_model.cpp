#include "raykiln/jobs/light_model.hpp"

#include <algorithm>

namespace raykiln::server {
namespace {

std::string_view onoff(bool value) { return value ? "true" : "false"; }

std::optional<bool> truth(std::string_view text) {
  if (text == "true") return true;
  if (text == "false") return false;
  return std::nullopt;
}

void append(std::string& text, std::string_view key, std::string_view value) {
  if (!text.empty()) text += ',';
  text.append(key).append("=").append(value);
}

/// Sets `target` and says whether the word was known.
template <class Value>
bool set(std::optional<Value>& target, std::optional<Value> value) {
  if (value) target = value;
  return value.has_value();
}

bool set_override(LightModelOverrides& o, std::string_view key, std::string_view value) {
  if (key == "phong") return set(o.phong, phong_divisor_named(value));
  if (key == "fresnel") return set(o.fresnel, fresnel_formula_named(value));
  if (key == "radiance_scaling") return set(o.radiance_scaling, truth(value));
  if (key == "diffuse_sampling") return set(o.diffuse_sampling, diffuse_sampling_named(value));
  if (key == "roulette") return set(o.roulette, truth(value));
  return false;
}

}  // namespace

std::string_view name(LightModel value) {
  return value == LightModel::kPhysical ? "physical" : "seed";
}
std::string_view name(PhongDivisor value) {
  return value == PhongDivisor::kMax ? "max" : "over_cos_o";
}
std::string_view name(FresnelFormula value) {
  return value == FresnelFormula::kExact ? "exact" : "schlick";
}
std::string_view name(DiffuseSampling value) {
  return value == DiffuseSampling::kCosine ? "cosine" : "uniform";
}

std::optional<LightModel> light_model_named(std::string_view text) {
  if (text == "physical") return LightModel::kPhysical;
  if (text == "seed") return LightModel::kSeed;
  return std::nullopt;
}
std::optional<PhongDivisor> phong_divisor_named(std::string_view text) {
  if (text == "max") return PhongDivisor::kMax;
  if (text == "over_cos_o") return PhongDivisor::kOverCosO;
  return std::nullopt;
}
std::optional<FresnelFormula> fresnel_formula_named(std::string_view text) {
  if (text == "exact") return FresnelFormula::kExact;
  if (text == "schlick") return FresnelFormula::kSchlick;
  return std::nullopt;
}
std::optional<DiffuseSampling> diffuse_sampling_named(std::string_view text) {
  if (text == "cosine") return DiffuseSampling::kCosine;
  if (text == "uniform") return DiffuseSampling::kUniform;
  return std::nullopt;
}

std::string light_model_label(LightModel model, const LightModelOverrides& overrides) {
  const std::string text = overrides_text(overrides);
  std::string label(name(model));
  return text.empty() ? label : label + " with " + text;
}

std::string overrides_text(const LightModelOverrides& o) {
  std::string text;
  if (o.phong) append(text, "phong", name(*o.phong));
  if (o.fresnel) append(text, "fresnel", name(*o.fresnel));
  if (o.radiance_scaling) append(text, "radiance_scaling", onoff(*o.radiance_scaling));
  if (o.diffuse_sampling) append(text, "diffuse_sampling", name(*o.diffuse_sampling));
  if (o.roulette) append(text, "roulette", onoff(*o.roulette));
  return text;
}

std::optional<LightModelOverrides> overrides_of(std::string_view text) {
  LightModelOverrides overrides;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    if (!set_override(overrides, word.substr(0, equals), word.substr(equals + 1))) {
      return std::nullopt;
    }
  }
  return overrides;
}

}  // namespace raykiln::server
