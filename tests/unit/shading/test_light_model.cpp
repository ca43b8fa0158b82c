#include <gtest/gtest.h>

#include <set>

#include "raykiln/shading/light_model.hpp"

namespace raykiln::render {
namespace {

TEST(LightModel, NamesSayTheNearerModelAndWhatDiffers) {
  EXPECT_EQ(name(kPhysicalModel), "physical");
  EXPECT_EQ(name(kSeedModel), "seed");
  LightModel model;
  model.phong = PhongCosine::kOverCosO;
  model.roulette = false;
  EXPECT_EQ(name(model), "physical with phong=over_cos_o,roulette=false");
  model = kSeedModel;
  model.radiance_scaling = true;
  EXPECT_EQ(name(model), "seed with radiance_scaling=true");
}

TEST(LightModel, EveryCombinationHasANameOfItsOwn) {
  std::set<std::string> names;
  for (unsigned bits = 0; bits < 32; ++bits) {
    LightModel m;
    if ((bits & 1) != 0) m.phong = PhongCosine::kOverCosO;
    if ((bits & 2) != 0) m.fresnel = FresnelFormula::kSchlick;
    m.radiance_scaling = (bits & 4) != 0;
    if ((bits & 8) != 0) m.diffuse_sampling = DiffuseSampling::kUniform;
    m.roulette = (bits & 16) != 0;
    names.insert(name(m));
  }
  EXPECT_EQ(names.size(), 32U);
}

}  // namespace
}  // namespace raykiln::render
