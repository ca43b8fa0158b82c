// Finding and opening the files that a scene file names.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "diagnostics.hpp"

namespace raykiln::render::io {

/// The file that `reference`, written in the file `from`, means: relative to the folder of `from`,
/// '\' as '/', "." and ".." resolved within the upload, otherwise the only file that differs in
/// upper and lower case. Nothing when there is none or when it would lie outside.
[[nodiscard]] std::optional<std::string> find_beside(const SceneFiles& files,
                                                     std::string_view from,
                                                     std::string_view reference);

/// Opens `name`; null, with the error recorded, when it is missing or larger than `max_bytes`.
[[nodiscard]] std::unique_ptr<SceneFile> open_limited(const SceneFiles& files,
                                                      const std::string& name,
                                                      std::uint64_t max_bytes,
                                                      Diagnostics& diagnostics);

/// The whole file; nothing, with the error recorded, when that fails. Grows with what is read, not
/// with what the file's size claims.
[[nodiscard]] std::optional<std::string> read_whole(const SceneFiles& files,
                                                    const std::string& name,
                                                    std::uint64_t max_bytes,
                                                    Diagnostics& diagnostics);

/// Lower-case ASCII letters of the part behind the last dot; empty without one.
[[nodiscard]] std::string extension_of(std::string_view name);
/// The folder part including its slash, or empty.
[[nodiscard]] std::string_view folder_of(std::string_view name);

}  // namespace raykiln::render::io
