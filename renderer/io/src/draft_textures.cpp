#include "draft_textures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raykiln/image/picture_file.hpp"
#include "raykiln/math/srgb.hpp"
#include "scene_file_names.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::array<std::uint32_t, 3> kNoCorners{kNoUv, kNoUv, kNoUv};

std::uint64_t bytes_of(const PictureFile& picture) {
  return picture.srgb8.size() + picture.linear.size() * sizeof(float);
}

PictureChannels channels_for(PictureRole role) {
  if (role == PictureRole::kCoverage) return PictureChannels::kAlpha;
  return role == PictureRole::kOpacity ? PictureChannels::kAlphaOrGrey : PictureChannels::kColour;
}

bool is_one_all_over(const PictureFile& picture) {
  return std::all_of(picture.srgb8.begin(), picture.srgb8.end(), [](std::uint8_t v) { return v == 255; }) &&
         std::all_of(picture.linear.begin(), picture.linear.end(), [](float v) { return v >= 1.0F; });
}

struct Values {
  std::uint64_t clamped = 0;
  double scale = 1.0;
};

/// Brings values to [0, 1]: colours by clamping them, emission by a power of two. Nothing if one is not
/// finite.
std::optional<Values> make_usable(std::vector<float>& values, PictureRole role) {
  Values result;
  float largest = 1.0F;
  for (float& value : values) {
    if (!std::isfinite(value)) return std::nullopt;
    const bool outside = value < 0.0F || (value > 1.0F && role != PictureRole::kEmission);
    if (outside) {
      ++result.clamped;
      value = std::clamp(value, 0.0F, 1.0F);
    }
    largest = std::max(largest, value);
  }
  if (largest > 1.0F) {
    int exponent = 0;
    (void)std::frexp(largest, &exponent);  // largest < 2^exponent
    result.scale = std::ldexp(1.0, exponent);
    for (float& value : values) value = std::ldexp(value, -exponent);
  }
  return result;
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
                   "add it to the upload as PNG, JPEG, EXR or HDR, or go on without it: "
                   "--allow-missing, ?allow_missing=true, or \"allow_missing\": true in raykiln.json");
  return std::nullopt;
}

std::optional<std::uint32_t> DraftTextures::known(const std::string& name, PictureRole role) const {
  const auto found = by_name_.find({name, role});
  return found == by_name_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint32_t> DraftTextures::beside(const SceneFiles& files,
                                                   std::string_view reference,
                                                   const PictureUser& user, PictureRole role,
                                                   Diagnostics& diagnostics) {
  const auto found = find_beside(files, user.file, reference);
  if (!found) {
    return unusable(ImportErrorCode::kFileMissing, "there is no texture " + in_quotes(reference),
                    user, diagnostics);
  }
  if (const auto id = known(*found, role)) return id;
  const auto bytes =
      read_whole(files, *found, diagnostics.limits().max_picture_file_bytes, diagnostics);
  if (!bytes) return std::nullopt;
  return embedded(*found, *bytes, user, role, diagnostics);
}

// Also what is left out is remembered: decoding a damaged picture once for each of a hundred thousand
// materials would take hours. PNG and JPEG of 8 bits are the same for all roles and held once.
std::optional<std::uint32_t> DraftTextures::embedded(const std::string& name, std::string_view bytes,
                                                     const PictureUser& user, PictureRole role,
                                                     Diagnostics& diagnostics) {
  if (const auto id = known(name, role)) return id;
  std::optional<std::uint32_t> id;
  const bool three = channels_for(role) == PictureChannels::kColour;
  for (const PictureRole other : {PictureRole::kColour, PictureRole::kEmission, PictureRole::kData}) {
    const auto twin = three ? known(name, other) : std::nullopt;
    if (twin && (*twin == kNoTexture || !images[*twin].srgb8.empty())) id = twin;
  }
  if (!id) id = decode(name, bytes, user, role, diagnostics);
  if (id) by_name_.emplace(std::pair(name, role), *id);
  return id;
}

std::optional<std::uint32_t> DraftTextures::decode(const std::string& name, std::string_view bytes,
                                                   const PictureUser& user, PictureRole role,
                                                   Diagnostics& diagnostics) {
  const ImportLimits& limits = diagnostics.limits();
  if (!diagnostics.may_go_on()) return std::nullopt;
  if (by_name_.size() >= limits.max_textures) {
    diagnostics.fail(ImportErrorCode::kLimitExceeded, "too many textures", user.file, user.where);
    return std::nullopt;
  }
  auto read = read_picture_file(
      {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
      {.max_pixels = limits.max_texture_texels, .max_bytes = limits.max_texture_bytes - bytes_},
      channels_for(role));
  const std::string label = "the texture " + in_quotes(name);
  if (const auto* error = std::get_if<PictureFileError>(&read)) {
    if (error->no_room) {
      diagnostics.fail(ImportErrorCode::kLimitExceeded,
                       "the textures take more than " + std::to_string(limits.max_texture_bytes) +
                           " bytes together",
                       user.file, user.where, "use smaller pictures");
      return std::nullopt;
    }
    return unusable(ImportErrorCode::kInvalidPicture, label + " cannot be used: " + error->message,
                    user, diagnostics);
  }
  auto& picture = std::get<PictureFile>(read);
  if (role == PictureRole::kData && picture.format == PictureFormat::kPng) {
    for (float& value : picture.linear) {  // of 16 bits, read as colours
      value = static_cast<float>(srgb_of_linear(static_cast<double>(value)));
    }
  }
  if (picture.channels == 1 && is_one_all_over(picture)) return kNoTexture;
  const auto values = make_usable(picture.linear, role);
  if (!values) {
    return unusable(ImportErrorCode::kNotFinite, label + " has values that are not finite", user,
                    diagnostics);
  }
  if (values->clamped > 0) {
    diagnostics.warn(ImportWarningCode::kClampedValue, label + " has values that are clamped: negative "
                     "ones, or colours above 1", user.file, user.where, values->clamped);
  }
  bytes_ += bytes_of(picture);
  const auto id = static_cast<std::uint32_t>(images.size());
  images.push_back({.name = clean_text(name),
                    .width = picture.width,
                    .height = picture.height,
                    .srgb8 = std::move(picture.srgb8),
                    .linear = std::move(picture.linear),
                    .channels = picture.channels});
  scales.push_back(values->scale);
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
