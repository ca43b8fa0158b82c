#include "raykiln/io/import.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "finish_scene.hpp"
#include "gltf_reader.hpp"
#include "obj_reader.hpp"
#include "root_file.hpp"
#include "scene_file_names.hpp"
#include "sidecar.hpp"

namespace raykiln::render {
namespace {

using io::Diagnostics;

bool exists(const std::vector<std::string>& names, const std::string& name) {
  return std::binary_search(names.begin(), names.end(), name);
}

// At the top, or else the only one in any folder (uploads often wrap everything in one folder).
std::optional<std::string> find_sidecar(const std::vector<std::string>& names) {
  const std::string top(kSidecarName);
  if (exists(names, top)) return top;
  std::optional<std::string> found;
  for (const std::string& name : names) {
    if (!name.ends_with("/" + top)) continue;
    if (found) return std::nullopt;
    found = name;
  }
  return found;
}

std::optional<std::string> find_root(const SceneFiles& files, const ImportOptions& options,
                                     const std::vector<std::string>& names,
                                     const std::optional<std::string>& sidecar_name,
                                     const std::optional<io::JsonDocument>& sidecar,
                                     Diagnostics& diagnostics) {
  if (!options.root_file.empty()) return options.root_file;
  if (sidecar && sidecar->root().has("scene")) {
    const io::JsonAt at = sidecar->root().member("scene");
    const auto wanted = at.text();
    if (!wanted) return std::nullopt;
    auto found = io::find_beside(files, *sidecar_name, *wanted);
    if (!found) {
      at.fail(ImportErrorCode::kFileMissing, "there is no file " + io::in_quotes(*wanted),
              "add the file to the upload");
    }
    return found;
  }
  return io::only_scene_file(names, diagnostics);
}

bool read_format(SceneFormat format, const SceneFiles& files, const std::string& name,
                 Diagnostics& diagnostics, io::SceneDraft& draft) {
  switch (format) {
    case SceneFormat::kObj: return io::read_obj(files, name, diagnostics, draft);
    case SceneFormat::kGltf: return io::read_gltf(files, name, diagnostics, draft);
    case SceneFormat::kGlb: return io::read_glb(files, name, diagnostics, draft);
  }
  return false;
}

bool import_into(const SceneFiles& files, const ImportOptions& options, Diagnostics& diagnostics,
                 ImportedScene& result) {
  if (!diagnostics.may_go_on()) return false;
  const std::vector<std::string> names = files.names();
  const auto sidecar_name = find_sidecar(names);
  std::optional<io::JsonDocument> sidecar;
  if (sidecar_name) {
    sidecar = io::read_sidecar(files, *sidecar_name, diagnostics);
    if (!sidecar) return false;
  }
  const auto root = find_root(files, options, names, sidecar_name, sidecar, diagnostics);
  if (!root) return false;
  const auto format = io::format_of(*root, diagnostics);
  if (!format) return false;
  result.report.format = *format;
  result.report.root_file = io::clean_text(*root);
  io::SceneDraft draft;
  draft.textures.allow_missing =
      (sidecar && sidecar->root().flag_or("allow_missing", false)) || options.allow_missing;
  if (diagnostics.failed()) return false;
  if (!read_format(*format, files, *root, diagnostics, draft)) return false;
  if (sidecar && !io::apply_sidecar(files, sidecar->root(), draft)) return false;
  return io::finish_scene(std::move(draft), diagnostics, result.scene, result.report);
}

}  // namespace

ImportResult import_scene(const SceneFiles& files, const ImportOptions& options) {
  Diagnostics diagnostics(options);
  ImportedScene result;
  if (!import_into(files, options, diagnostics, result)) return diagnostics.take_error();
  result.report.warnings = diagnostics.take_warnings();
  return result;
}

}  // namespace raykiln::render
