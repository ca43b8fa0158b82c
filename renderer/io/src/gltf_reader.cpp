#include "gltf_reader.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "glb_container.hpp"
#include "gltf_accessor.hpp"
#include "gltf_buffers.hpp"
#include "gltf_materials.hpp"
#include "gltf_meshes.hpp"
#include "gltf_nodes.hpp"
#include "json_at.hpp"
#include "scene_file_names.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::array<std::string_view, 10> kSupported{
    "KHR_materials_diffuse_transmission",
    "KHR_lights_punctual",        "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",     "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",      "KHR_texture_transform"};

// They change how textures are stored only: a texture that is used and has no other source is an
// error of its own.
constexpr std::array<std::string_view, 4> kTextureOnly{"EXT_texture_avif", "EXT_texture_webp",
                                                       "KHR_texture_basisu", "MSFT_texture_dds"};

template <std::size_t N>
bool contains(const std::array<std::string_view, N>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

bool check_version(const JsonAt& root) {
  const auto asset = root.object("asset");
  if (!asset) {
    return root.fail(ImportErrorCode::kMissingField, "there is no asset object: not a glTF 2.0 file");
  }
  const std::string version = asset->is_text("version") ? asset->text_or("version", "") : "(none)";
  if (version.starts_with("2.")) return true;
  return asset->fail(ImportErrorCode::kUnsupportedVersion,
                     "glTF version " + in_quotes(version) + " is not supported, only 2.0 is",
                     "convert the file to glTF 2.0");
}

bool check_extensions(const JsonAt& root) {
  const auto required = root.array("extensionsRequired");
  for (std::size_t i = 0; required && i < required->size(); ++i) {
    const auto extension = required->element(i).text();
    if (!extension) return false;
    if (contains(kSupported, *extension) || contains(kTextureOnly, *extension)) continue;
    return required->element(i).fail(
        ImportErrorCode::kUnsupportedExtension,
        "the file requires the extension " + in_quotes(*extension) + ", which is not supported",
        "export without it");
  }
  const auto used = root.array("extensionsUsed");
  for (std::size_t i = 0; used && i < used->size(); ++i) {
    const auto extension = used->element(i).text();
    if (!extension) return false;
    if (contains(kSupported, *extension)) continue;
    used->element(i).warn(ImportWarningCode::kIgnoredExtension,
                          "the extension " + in_quotes(*extension) + " is ignored");
  }
  return !root.diagnostics().failed();
}

bool read_document(const SceneFiles& files, const JsonAt& root,
                   std::optional<std::string_view> glb_chunk, SceneDraft& draft) {
  if (!root.expect_object() || !check_version(root) || !check_extensions(root)) return false;
  if (root.has("animations")) {
    root.warn(ImportWarningCode::kIgnoredFeature,
              "animations are ignored: the rest pose is shown");
  }
  draft.single_precision = true;
  GltfBuffers buffers(files, root, glb_chunk);
  GltfTextures textures(files, root, buffers, draft);
  auto materials = read_gltf_materials(root, textures, draft);
  if (!materials) return false;
  GltfAccessors accessors(root, buffers);
  GltfMeshes meshes(root, accessors, std::move(*materials), draft);
  return !root.diagnostics().failed() && GltfNodes(root, meshes, draft).walk();
}

std::optional<JsonDocument> parse_file(const SceneFiles& files, const std::string& name,
                                       Diagnostics& diagnostics) {
  const auto text = read_whole(files, name, diagnostics.limits().max_json_bytes, diagnostics);
  if (!text) return std::nullopt;
  return JsonDocument::parse(*text, name, diagnostics);
}

}  // namespace

bool read_gltf(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
               SceneDraft& draft) {
  const auto document = parse_file(files, name, diagnostics);
  return document && read_document(files, document->root(), std::nullopt, draft);
}

bool read_glb(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
              SceneDraft& draft) {
  const auto bytes = read_whole(files, name, diagnostics.limits().max_buffer_bytes, diagnostics);
  if (!bytes) return false;
  const auto chunks = split_glb(*bytes, name, diagnostics);
  if (!chunks) return false;
  const auto document = JsonDocument::parse(chunks->json, name, diagnostics);
  return document && read_document(files, document->root(), chunks->binary, draft);
}

}  // namespace raykiln::render::io
