// All effects, a row each, in the order in which people read them: the name in code (kRefraction,
// kRefractionRow) and the name for everybody else, which is also that of its file in src/. Nothing
// else lists them: the enum, the table and the build are made from this.
#pragma once

// One a line and nothing between: CMakeLists.txt reads it too.
#define RAYKILN_EFFECTS(ROW)                     \
  ROW(PointLights, point_lights)                 \
  ROW(SpotLights, spot_lights)                   \
  ROW(DirectionalLights, directional_lights)     \
  ROW(PointLightShadows, point_light_shadows)    \
  ROW(AreaEmitters, area_emitters)               \
  ROW(EmitterSampling, emitter_sampling)         \
  ROW(Background, background)                    \
  ROW(Environment, environment)                  \
  ROW(DiffuseReflection, diffuse_reflection)     \
  ROW(DiffuseTransmission, diffuse_transmission) \
  ROW(GlossyLobes, glossy_lobes)                 \
  ROW(Mirrors, mirrors)                          \
  ROW(MicrofacetLobes, microfacet_lobes)         \
  ROW(AlphaCoverage, alpha_coverage)             \
  ROW(OneSidedSurfaces, one_sided_surfaces)      \
  ROW(Refraction, refraction)                    \
  ROW(Fresnel, fresnel)                          \
  ROW(ShadingNormals, shading_normals)           \
  ROW(Textures, textures)                        \
  ROW(IndirectLight, indirect_light)             \
  ROW(Caustics, caustics)                        \
  ROW(Roulette, roulette)                        \
  ROW(DepthOfField, depth_of_field)              \
  ROW(WatertightTriangles, watertight_triangles)
