// Reading the files of a scene, unpacked first where they come in a zip.
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/io/import.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// What becomes of a scene whose textures are missing or cannot be read.
enum class MissingTextures { kRefuse, kLeaveOut };

/// What the importer says about the files. Errors: "scene_empty" and those of unpack_zip. `scratch`
/// makes a private directory to unpack into, which is removed.
[[nodiscard]] Result<render::ImportResult> import_files(
    SceneKind kind, const std::vector<BlobFile>& files, const UploadLimits& limits, MissingTextures missing,
    const std::function<Result<std::filesystem::path>()>& scratch, std::stop_token stop);

}  // namespace raykiln::server
