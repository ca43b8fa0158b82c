// Which files of this machine make up the scene that a user names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "raykiln/base/result.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

struct ScenePackage {
  SceneKind kind = SceneKind::kFiles;
  std::string name;             ///< for people
  std::vector<BlobFile> files;  ///< sorted by name; one for zip and glb
  bool allow_missing = false;   ///< missing textures are left out; no part of the id
};

/// `path`: a .zip or .glb, a .obj (with its mtllib files, their textures and raykiln.json beside
/// it), a .gltf (with the files that its uris name), or a folder with all of it. Errors: kNotFound "file_missing", kInvalid
/// "scene_unsupported", kTooLarge "payload_too_large" for a folder of more than 256 files.
[[nodiscard]] Result<ScenePackage> find_scene_files(const std::filesystem::path& path);

/// The id that the server will give it (see POST /v1/scenes of the contract): reads all files.
[[nodiscard]] Result<std::string> scene_id(const ScenePackage& package);

}  // namespace raykiln::server
