// The file of a linear picture: a head with size and digest, then the floats.
#pragma once

#include <filesystem>

#include "raykiln/base/result.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Writes and flushes a new file.
Status write_image_file(const std::filesystem::path& path, const StoredImage& image);
/// "image_not_ready" when there is none, "internal" when it is torn (size or digest is wrong).
[[nodiscard]] Result<StoredImage> read_image_file(const std::filesystem::path& path);
/// Bytes that the file of such a picture takes.
[[nodiscard]] std::uint64_t image_file_bytes(const StoredImage& image);

}  // namespace raykiln::server
