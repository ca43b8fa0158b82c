#include "gltf_materials.hpp"

#include <algorithm>
#include <string>

#include "material_mapping.hpp"

namespace raykiln::render::io {
namespace {

constexpr double kLargestWeight = 1e6;

void note_texture(const JsonAt& at, const char* key) {
  if (!at.has(key)) return;
  at.warn(ImportWarningCode::kIgnoredTexture,
          "textures of this kind are not supported yet: " + std::string(key) +
              " is ignored, factors are used");
}

void set_base_color(const JsonAt& at, const char* key, GltfMaterial& material) {
  const auto found = at.find(key);
  if (!found) return;
  const auto v = found->numbers(4);
  if (!v) return;
  for (const double component : *v) {
    if (component >= 0.0 && component <= kLargestWeight) continue;
    found->fail(ImportErrorCode::kInvalidValue, "a component is outside of its range");
    return;
  }
  material.base_color = Rgbd((*v)[0], (*v)[1], (*v)[2]);
  material.alpha = std::min((*v)[3], 1.0);
}

void read_metallic_roughness(const JsonAt& at, GltfMaterial& material) {
  set_base_color(at, "baseColorFactor", material);
  material.metallic = at.number_in("metallicFactor", 1.0, 0.0, 1.0);
  material.roughness = at.number_in("roughnessFactor", 1.0, 0.0, 1.0);
}

// Written as a dielectric whose reflectance is the specular colour.
void read_specular_glossiness(const JsonAt& at, GltfMaterial& material) {
  set_base_color(at, "diffuseFactor", material);
  material.metallic = 0.0;
  material.roughness = 1.0 - at.number_in("glossinessFactor", 1.0, 0.0, 1.0);
  material.specular_color = at.vec3_in("specularFactor", Vec3d(1.0), 0.0, 1.0) / 0.04;
  note_texture(at, "specularGlossinessTexture");
}

// The share c of light is left after the distance d: absorption -ln(c)/d. Black is left at 1e-4.
void read_volume(const JsonAt& at, GltfMaterial& material) {
  material.thickness = at.number_in("thicknessFactor", 0.0, 0.0, 1e15);
  note_texture(at, "thicknessTexture");
  const Rgbd colour = at.vec3_in("attenuationColor", Vec3d(1.0), 0.0, 1.0);
  if (!at.has("attenuationDistance")) return;
  const double distance = at.number_in("attenuationDistance", 1.0, 1e-12, 1e15);
  material.absorption = -glm::log(glm::max(colour, Rgbd(1e-4))) / distance;
}

void read_extensions(const JsonAt& at, GltfMaterial& material) {
  const auto extensions = at.object("extensions");
  if (!extensions) return;
  if (const auto e = extensions->object("KHR_materials_emissive_strength")) {
    material.emissive_strength = e->number_in("emissiveStrength", 1.0, 0.0, 1e12);
  }
  if (const auto e = extensions->object("KHR_materials_ior")) {
    const double ior = e->number_or("ior", 1.5);
    if (ior != 0.0 && !(ior >= 1.0 && ior <= 1e6)) {
      e->fail(ImportErrorCode::kInvalidValue, "ior is 0 or at least 1");
    }
    material.ior = ior == 0.0 ? 1e6 : ior;  // 0 stands for "reflects everything"
  }
  if (const auto e = extensions->object("KHR_materials_transmission")) {
    material.transmission = e->number_in("transmissionFactor", 0.0, 0.0, 1.0);
    note_texture(*e, "transmissionTexture");
  }
  if (const auto e = extensions->object("KHR_materials_diffuse_transmission")) {
    material.diffuse_transmission = e->number_in("diffuseTransmissionFactor", 0.0, 0.0, 1.0);
    material.diffuse_transmission_color =
        e->vec3_in("diffuseTransmissionColorFactor", Vec3d(1.0), 0.0, kLargestWeight);
  }
  if (const auto e = extensions->object("KHR_materials_volume")) read_volume(*e, material);
  if (const auto e = extensions->object("KHR_materials_specular")) {
    material.specular = e->number_in("specularFactor", 1.0, 0.0, 1.0);
    material.specular_color = e->vec3_in("specularColorFactor", Vec3d(1.0), 0.0, kLargestWeight);
    note_texture(*e, "specularTexture");
    note_texture(*e, "specularColorTexture");
  }
  if (const auto e = extensions->object("KHR_materials_pbrSpecularGlossiness")) {
    read_specular_glossiness(*e, material);
  }
}

void read_emission(const JsonAt& at, GltfMaterial& material) {
  material.emissive = at.vec3_in("emissiveFactor", Vec3d(0.0), 0.0, kLargestWeight);
}

bool read_surface_textures(const JsonAt& at, const std::optional<JsonAt>& roughness,
                           GltfTextures& textures, const GltfMaterial& material,
                           MaterialTextures& used) {
  const auto normal = textures.use(at, "normalTexture", PictureRole::kData);
  if (!normal) return false;
  used.normal = *normal;
  if (used.normal.used()) {
    used.normal_scale = at.object("normalTexture")->number_in("scale", 1.0, -1e3, 1e3);
  }
  if (!roughness) return !at.diagnostics().failed();
  const auto mixed = textures.use(*roughness, "metallicRoughnessTexture", PictureRole::kData);
  if (!mixed) return false;
  used.roughness = *mixed;
  used.metal = metallic_roughness(material);
  return !at.diagnostics().failed();
}

// The alpha of the base colour: share of the surface that is there (BLEND), or whether it is there at all
// (MASK). `holder` has that texture. One that was left out, or whose picture has no alpha, counts as 1.
bool read_coverage(const JsonAt& at, const std::optional<JsonAt>& holder, GltfTextures& textures,
                   GltfMaterial& material, MaterialTextures& used) {
  const std::string mode = at.text_or("alphaMode", "OPAQUE");
  if (mode == "OPAQUE") {
    material.alpha = 1.0;
    return !at.diagnostics().failed();
  }
  if (mode != "MASK" && mode != "BLEND") {
    return at.member("alphaMode").fail(ImportErrorCode::kInvalidValue,
                                       "there is no alpha mode " + in_quotes(mode));
  }
  const bool left_out = material.base_color != Rgbd(0.0) && !used.base.used();
  if (holder && !left_out) {
    const char* key = holder->has("diffuseTexture") ? "diffuseTexture" : "baseColorTexture";
    const auto alpha = textures.use(*holder, key, PictureRole::kCoverage);
    if (!alpha) return false;
    used.alpha = *alpha;
  }
  if (mode == "MASK") {
    const double cutoff = at.number_in("alphaCutoff", 0.5, 0.0, kLargestWeight);
    if (used.alpha.used()) {
      used.alpha_cutoff = cutoff;
    } else {
      material.alpha = material.alpha < cutoff ? 0.0 : 1.0;
    }
  }
  return !at.diagnostics().failed();
}

// Neither is read where nothing is transmitted.
bool read_diffuse_transmission(const std::optional<JsonAt>& extensions, GltfTextures& textures,
                               const GltfMaterial& material, MaterialTextures& used) {
  const auto at = extensions ? extensions->object("KHR_materials_diffuse_transmission") : std::nullopt;
  if (!at || material.diffuse_transmission == 0.0) return true;
  const auto share = textures.use(*at, "diffuseTransmissionTexture", PictureRole::kCoverage);
  if (!share) return false;
  const auto colour = textures.use(*at, "diffuseTransmissionColorTexture", PictureRole::kColour);
  if (!colour) return false;
  used.through = *share;
  used.through_colour = *colour;
  if (used.through.used()) used.metal = metallic_roughness(material);
  return true;
}

// A base colour texture of a black base colour, or an emissive one of no emission, is not read.
bool read_textures(const JsonAt& at, GltfTextures& textures, GltfMaterial& material,
                   MaterialTextures& used) {
  const auto extensions = at.object("extensions");
  const auto glossiness =
      extensions ? extensions->object("KHR_materials_pbrSpecularGlossiness") : std::nullopt;
  const auto roughness = at.object("pbrMetallicRoughness");
  const auto& holder = glossiness ? glossiness : roughness;
  if (holder && material.base_color != Rgbd(0.0)) {
    const auto base = textures.use(*holder, glossiness ? "diffuseTexture" : "baseColorTexture",
                                   PictureRole::kColour);
    if (!base) return false;
    used.base = *base;
    used.specular_tint = specular_tint(material);
  }
  if (!read_coverage(at, holder, textures, material, used)) return false;
  if (!read_diffuse_transmission(extensions, textures, material, used)) return false;
  if (!read_surface_textures(at, roughness, textures, material, used)) return false;
  if (!at.has("emissiveTexture") || material.emissive == Rgbd(0.0)) {
    return !at.diagnostics().failed();
  }
  const auto emission = textures.use(at, "emissiveTexture", PictureRole::kEmission);
  if (!emission) return false;
  used.emission = *emission;
  // The texture decides where the surface glows: without it, nowhere.
  if (!used.emission.used()) material.emissive = Rgbd(0.0);
  return true;
}

std::string unique_name(const JsonAt& at, std::size_t index, const MaterialTable& table) {
  std::string name = clean_text(at.text_or("name", ""), kMaxNameBytes);
  if (name.empty()) name = "material " + std::to_string(index);
  std::string candidate = name;
  for (std::size_t i = index; table.contains(candidate); ++i) {
    candidate = name + " #" + std::to_string(i);
  }
  return candidate;
}

std::uint32_t read_material(const JsonAt& at, std::size_t index, GltfTextures& textures,
                            SceneDraft& draft) {
  GltfMaterial material;
  material.name = unique_name(at, index, draft.materials);
  if (const auto pbr = at.object("pbrMetallicRoughness")) read_metallic_roughness(*pbr, material);
  material.double_sided = at.flag_or("doubleSided", false);
  read_emission(at, material);
  read_extensions(at, material);
  note_texture(at, "occlusionTexture");
  MaterialTextures used;
  if (!at.diagnostics().failed() && !read_textures(at, textures, material, used)) return 0;
  const std::uint32_t id = draft.materials.intern(material.name);
  if (used.used()) draft.textures.of_material(id) = used;
  draft.materials.materials[id] = to_material(material);
  draft.materials.as_phong[id] = to_phong(material);
  draft.materials.defined[id] = true;
  return id;
}

}  // namespace

std::optional<std::vector<std::uint32_t>> read_gltf_materials(const JsonAt& root,
                                                              GltfTextures& textures,
                                                              SceneDraft& draft) {
  std::vector<std::uint32_t> ids;
  const auto materials = root.array("materials");
  if (root.diagnostics().failed()) return std::nullopt;
  if (!materials) return ids;
  if (materials->size() > root.diagnostics().limits().max_materials) {
    materials->fail(ImportErrorCode::kLimitExceeded, "too many materials");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < materials->size(); ++i) {
    const JsonAt at = materials->element(i);
    if (!at.expect_object()) return std::nullopt;
    ids.push_back(read_material(at, i, textures, draft));
    if (!root.diagnostics().may_go_on()) return std::nullopt;
  }
  return ids;
}

}  // namespace raykiln::render::io
