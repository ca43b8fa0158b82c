// Zip archives of strangers. libarchive is used behind this header and nowhere else.
#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Unpacks the regular files of a zip into `directory` as 0, 1, 2, ...: names of the archive are
/// never used as paths. Refused, with the entry in `where`: archive_invalid (unreadable,
/// truncated, encrypted, a link or special file), unsafe_name (absolute, "..", control
/// characters, the same name twice), archive_too_large (entries, bytes, or the ratio of a bomb),
/// scene_empty. libarchive turns the backslashes of archives made on Windows into slashes; names are
/// checked after that. Bytes are counted as they are written,
/// headers are not believed. The caller removes the directory.
[[nodiscard]] Result<std::vector<BlobFile>> unpack_zip(const std::filesystem::path& archive,
                                                       const std::filesystem::path& directory,
                                                       const UploadLimits& limits,
                                                       std::stop_token stop);

}  // namespace raykiln::server
