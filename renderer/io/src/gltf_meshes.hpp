// Meshes of a glTF file, placed in the world.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gltf_accessor.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

class GltfMeshes {
 public:
  GltfMeshes(const JsonAt& root, GltfAccessors& accessors, std::vector<std::uint32_t> material_ids,
             SceneDraft& draft);

  /// Appends all primitives of mesh `index` under `to_world`; a mirroring transform flips the
  /// winding, normals follow the inverse transpose. `at` is who refers to the mesh.
  bool instantiate(std::uint64_t index, const Mat4d& to_world, const JsonAt& at);

 private:
  struct Placed {
    std::uint32_t first_position = 0;
    std::uint32_t first_normal = kNoNormal;  ///< kNoNormal: the primitive has none
    std::array<std::uint32_t, 2> first_uv{kNoUv, kNoUv};  ///< of the sets that its material reads
    std::uint64_t vertices = 0;
    std::uint32_t material = 0;
    bool mirrored = false;
  };
  bool primitive(const JsonAt& at, const Mat4d& to_world);
  bool place_vertices(const JsonAt& at, const JsonAt& attributes, const Mat4d& to_world,
                      Placed& placed);
  bool place_normals(const JsonAt& at, const JsonAt& attributes, const Mat4d& to_world,
                     Placed& placed);
  bool place_uvs(const JsonAt& at, const JsonAt& attributes, std::size_t set, Placed& placed);
  bool material_of(const JsonAt& at, std::uint32_t& id);
  bool triangles(const JsonAt& at, std::uint64_t mode, const Placed& placed);
  void note_ignored(const JsonAt& at, const JsonAt& attributes);

  std::optional<JsonAt> meshes_;
  GltfAccessors* accessors_;
  std::vector<std::uint32_t> material_ids_;
  SceneDraft* draft_;
  std::uint64_t primitive_visits_ = 0;
};

}  // namespace raykiln::render::io
