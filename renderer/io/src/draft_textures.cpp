#include "draft_textures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raykiln/image/picture_file.hpp"
#include "scene_file_names.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::array<std::uint32_t, 3> kNoCorners{kNoUv, kNoUv, kNoUv};

std::uint64_t bytes_of(const PictureFile& picture) {
  return picture.srgb8.size() + picture.linear.size() * sizeof(float);
}

/// Negative values become 0. False if one is not finite.
bool make_usable(std::vector<float>& values) {
  for (float& value : values) {
    if (!std::isfinite(value)) return false;
    value = std::max(value, 0.0F);
  }
  return true;
}

}  // namespace

std::optional<std::uint32_t> DraftTextures::unusable(ImportErrorCode code,
                                                     const std::string& reason,
                                                     const PictureUser& user,
                                                     Diagnostics& diagnostics) {
  if (allow_missing) {
    diagnostics.warn(ImportWarningCode::kIgnoredTexture, reason + "; it is left out", user.file,
                     user.where);
    return kNoTexture;
  }
  diagnostics.fail(code, reason, user.file, user.where,
                   "add it to the upload as PNG, JPEG, EXR or HDR, or set \"allow_missing\" in "
                   "raykiln.json");
  return std::nullopt;
}

std::optional<std::uint32_t> DraftTextures::beside(const SceneFiles& files,
                                                   std::string_view reference,
                                                   const PictureUser& user,
                                                   Diagnostics& diagnostics) {
  const auto found = find_beside(files, user.file, reference);
  if (!found) {
    return unusable(ImportErrorCode::kFileMissing, "there is no texture " + in_quotes(reference),
                    user, diagnostics);
  }
  const std::string key = "file " + *found;
  if (const auto known = by_key_.find(key); known != by_key_.end()) return known->second;
  const auto bytes =
      read_whole(files, *found, diagnostics.limits().max_picture_file_bytes, diagnostics);
  if (!bytes) return std::nullopt;
  return embedded(key, *bytes, user, diagnostics);
}

std::optional<std::uint32_t> DraftTextures::embedded(const std::string& key, std::string_view bytes,
                                                     const PictureUser& user,
                                                     Diagnostics& diagnostics) {
  if (const auto known = by_key_.find(key); known != by_key_.end()) return known->second;
  const ImportLimits& limits = diagnostics.limits();
  if (!diagnostics.may_go_on()) return std::nullopt;
  if (images.size() >= limits.max_textures) {
    diagnostics.fail(ImportErrorCode::kLimitExceeded, "too many textures", user.file, user.where);
    return std::nullopt;
  }
  auto read = read_picture_file({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                                limits.max_texture_texels);
  const std::string label = "the texture " + in_quotes(key.substr(key.find(' ') + 1));
  if (const auto* error = std::get_if<PictureFileError>(&read)) {
    return unusable(ImportErrorCode::kInvalidPicture, label + " cannot be used: " + error->message,
                    user, diagnostics);
  }
  auto& picture = std::get<PictureFile>(read);
  if (!make_usable(picture.linear)) {
    return unusable(ImportErrorCode::kNotFinite, label + " has values that are not finite", user,
                    diagnostics);
  }
  bytes_ += bytes_of(picture);
  if (bytes_ > limits.max_texture_bytes) {
    diagnostics.fail(ImportErrorCode::kLimitExceeded,
                     "the textures take more than " + std::to_string(limits.max_texture_bytes) +
                         " bytes together",
                     user.file, user.where, "use smaller pictures");
    return std::nullopt;
  }
  const auto id = static_cast<std::uint32_t>(images.size());
  images.push_back({.name = clean_text(key.substr(key.find(' ') + 1)),
                    .width = picture.width,
                    .height = picture.height,
                    .srgb8 = std::move(picture.srgb8),
                    .linear = std::move(picture.linear)});
  by_key_.emplace(key, id);
  return id;
}

MaterialTextures& DraftTextures::of_material(std::uint32_t id) {
  if (id >= materials.size()) materials.resize(std::size_t{id} + 1);
  return materials[id];
}

bool DraftTextures::any() const {
  return std::any_of(materials.begin(), materials.end(),
                     [](const MaterialTextures& m) { return m.used(); });
}

void DraftTextures::add_corners(std::size_t set, std::size_t id,
                                const std::array<std::uint32_t, 3>& corners) {
  uv_sets[set].corners.resize(id, kNoCorners);
  uv_sets[set].corners.push_back(corners);
}

}  // namespace raykiln::render::io
