#include "raykiln/shading/light_model.hpp"

#include <array>
#include <cstddef>

namespace raykiln::render {
namespace {

using Switches = std::array<std::string, 5>;

std::string formula(FresnelFormula value) {
  switch (value) {
    case FresnelFormula::kExact: return "exact";
    case FresnelFormula::kSchlick: return "schlick";
    case FresnelFormula::kNone: break;
  }
  return "none";
}

std::string onoff(bool value) { return value ? "true" : "false"; }

Switches switches(const LightModel& m) {
  return {std::string("phong=") + (m.phong == PhongCosine::kMax ? "max" : "over_cos_o"),
          "fresnel=" + formula(m.fresnel),
          "radiance_scaling=" + onoff(m.radiance_scaling),
          std::string("diffuse_sampling=") +
              (m.diffuse_sampling == DiffuseSampling::kCosine ? "cosine" : "uniform"),
          "roulette=" + onoff(m.roulette)};
}

struct Difference {
  std::size_t count = 0;
  std::string text;  ///< the switches of the model, where they are not those of the base
};

Difference difference(const LightModel& model, const LightModel& base) {
  Difference d;
  const Switches mine = switches(model), other = switches(base);
  for (std::size_t i = 0; i < mine.size(); ++i) {
    if (mine[i] == other[i]) continue;
    d.text += (d.count == 0 ? "" : ",") + mine[i];
    ++d.count;
  }
  return d;
}

}  // namespace

std::string name(const LightModel& model) {
  const Difference physical = difference(model, kPhysicalModel);
  const Difference seed = difference(model, kSeedModel);
  const bool near_seed = seed.count < physical.count;
  const std::string base = near_seed ? "seed" : "physical";
  const Difference& d = near_seed ? seed : physical;
  return d.count == 0 ? base : base + " with " + d.text;
}

}  // namespace raykiln::render
