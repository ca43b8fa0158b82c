#include "root_file.hpp"

#include "scene_file_names.hpp"

namespace raykiln::render::io {
namespace {

std::optional<SceneFormat> known_format(const std::string& name) {
  const std::string extension = extension_of(name);
  if (extension == "obj") return SceneFormat::kObj;
  if (extension == "gltf") return SceneFormat::kGltf;
  if (extension == "glb") return SceneFormat::kGlb;
  return std::nullopt;
}

constexpr std::size_t kMaxListed = 5;

}  // namespace

std::optional<std::string> only_scene_file(const std::vector<std::string>& names,
                                           Diagnostics& diagnostics) {
  std::vector<std::string> candidates;
  for (const std::string& name : names) {
    if (known_format(name)) candidates.push_back(name);
  }
  if (candidates.size() == 1) return candidates[0];
  if (candidates.empty()) {
    diagnostics.fail(ImportErrorCode::kNoSceneFile,
                     "none of the " + std::to_string(names.size()) +
                         " files of the upload is a .gltf, .glb or .obj",
                     "", "", "add the scene file");
    return std::nullopt;
  }
  std::string list;
  for (std::size_t i = 0; i < candidates.size() && i < kMaxListed; ++i) {
    list += (i > 0 ? ", " : "") + in_quotes(candidates[i]);
  }
  if (candidates.size() > kMaxListed) list += ", ...";
  diagnostics.fail(ImportErrorCode::kAmbiguousScene,
                   std::to_string(candidates.size()) + " files could be the scene: " + list, "", "",
                   "name one in raykiln.json: {\"scene\": \"file\"}");
  return std::nullopt;
}

std::optional<SceneFormat> format_of(const std::string& name, Diagnostics& diagnostics) {
  const auto format = known_format(name);
  if (!format) {
    diagnostics.fail(ImportErrorCode::kNoSceneFile,
                     in_quotes(name) + " is not a .gltf, .glb or .obj file", name);
  }
  return format;
}

}  // namespace raykiln::render::io
