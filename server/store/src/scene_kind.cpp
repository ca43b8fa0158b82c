#include "raykiln/store/store.hpp"

namespace raykiln::server {

std::string_view name(SceneKind kind) {
  switch (kind) {
    case SceneKind::kZip: return "zip";
    case SceneKind::kGlb: return "glb";
    case SceneKind::kFiles: return "files";
  }
  return "";
}

std::optional<SceneKind> scene_kind_named(std::string_view text) {
  for (const SceneKind kind : {SceneKind::kZip, SceneKind::kGlb, SceneKind::kFiles}) {
    if (name(kind) == text) return kind;
  }
  return std::nullopt;
}

}  // namespace raykiln::server
