// The node tree of a glTF file: transforms, cameras, lights, meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "gltf_meshes.hpp"

namespace raykiln::render::io {

class GltfNodes {
 public:
  GltfNodes(JsonAt root, GltfMeshes& meshes, SceneDraft& draft);

  /// Walks the default scene (or the first, or all root nodes of a file without scenes). Refuses
  /// cycles, too deep trees and too many visits.
  bool walk();

 private:
  bool roots(std::vector<std::uint64_t>& ids);
  bool visit(std::uint64_t index, const Mat4d& parent, std::size_t depth, const JsonAt& at);
  bool contents(const JsonAt& node, const Mat4d& to_world);
  bool camera(const JsonAt& node, std::uint64_t index, const Mat4d& to_world);
  bool light(const JsonAt& node, std::uint64_t index, const Mat4d& to_world);

  JsonAt root_;
  std::optional<JsonAt> nodes_;
  GltfMeshes* meshes_;
  SceneDraft* draft_;
  std::vector<bool> on_path_;
  std::uint64_t visits_ = 0;
};

}  // namespace raykiln::render::io
