// Names of the pictures of a batch: one rule for clients and server.
#pragma once

#include <string>
#include <string_view>

namespace raykiln::server {

inline constexpr std::size_t kMostPictureName = 200;  ///< bytes

/// Letters, digits, '.', '_' and '-'; others become '_'. At most 100 bytes, and no '.' in front.
[[nodiscard]] std::string file_name_text(std::string_view text);

/// scene-camera-setting, without those that are empty: fit for a file name.
[[nodiscard]] std::string picture_name(std::string_view scene, std::string_view camera, std::string_view setting);

}  // namespace raykiln::server
