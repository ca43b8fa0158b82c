#include "environment.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "raykiln/image/picture_file.hpp"
#include "raykiln/scene/environment_map.hpp"
#include "scene_file_names.hpp"

namespace raykiln::render::io {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

std::optional<std::string> file_of(const SceneFiles& files, const JsonAt& at) {
  if (!at.has("file")) {
    at.fail(ImportErrorCode::kMissingField, "the field 'file' is missing");
    return std::nullopt;
  }
  const JsonAt field = at.member("file");
  const auto wanted = field.text();
  if (!wanted) return std::nullopt;
  auto found = find_beside(files, at.file(), *wanted);
  if (!found) {
    field.fail(ImportErrorCode::kFileMissing,
               "there is no file " + in_quotes(*wanted) + " for the environment",
               "add the file to the upload");
  }
  return found;
}

std::optional<PictureFile> read_map(const SceneFiles& files, const std::string& name,
                                    const JsonAt& at) {
  Diagnostics& diagnostics = at.diagnostics();
  const ImportLimits& limits = diagnostics.limits();
  const auto bytes = read_whole(files, name, limits.max_picture_file_bytes, diagnostics);
  if (!bytes || !diagnostics.may_go_on()) return std::nullopt;
  auto read = read_picture_file({reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()},
                                {.max_pixels = limits.max_environment_texels});
  if (const auto* error = std::get_if<PictureFileError>(&read)) {
    diagnostics.fail(ImportErrorCode::kInvalidPicture,
                     "the environment map is no picture that can be used: " + error->message, name,
                     "", "use an equirectangular EXR or HDR file");
    return std::nullopt;
  }
  auto& picture = std::get<PictureFile>(read);
  if (picture.format != PictureFormat::kExr && picture.format != PictureFormat::kHdr) {
    diagnostics.fail(ImportErrorCode::kInvalidPicture,
                     "an environment map is linear light: an EXR or HDR file, not " +
                         std::string(render::name(picture.format)),
                     name);
    return std::nullopt;
  }
  return std::move(picture);
}

/// Radiances from what the file holds: times `scale`, negative ones 0.
bool to_radiance(std::vector<float>& values, double scale, const std::string& name,
                 Diagnostics& diagnostics) {
  const double most = diagnostics.limits().max_radiance;
  std::uint64_t clamped = 0;
  for (float& value : values) {
    if (!std::isfinite(value)) {
      return diagnostics.fail(ImportErrorCode::kNotFinite,
                              "the environment map has values that are not finite", name, "",
                              "half floats end at 65504: lower the exposure and raise 'scale'");
    }
    const double scaled = static_cast<double>(value) * scale;
    clamped += scaled < 0.0 || scaled > most ? 1U : 0U;
    value = static_cast<float>(std::clamp(scaled, 0.0, most));
  }
  if (clamped > 0) {
    diagnostics.warn(ImportWarningCode::kClampedValue,
                     "radiances of the environment map that are negative or too large are clamped",
                     name, "", clamped);
  }
  return true;
}

}  // namespace

bool read_environment(const SceneFiles& files, const JsonAt& root, SceneDraft& draft) {
  const auto at = root.object("environment");
  if (!at) return !root.diagnostics().failed();
  if (!at->only({"file", "rotation_degrees", "scale"})) return false;
  if (root.has("background")) {
    return at->fail(ImportErrorCode::kInvalidValue,
                    "a scene has a background or an environment, not both", "remove one of them");
  }
  const double rotation = at->number_in("rotation_degrees", 0.0, -3600.0, 3600.0) * kDegree;
  const double scale = at->number_in("scale", 1.0, 0.0, 1e12);
  if (root.diagnostics().failed()) return false;
  const auto name = file_of(files, *at);
  auto picture = name ? read_map(files, *name, *at) : std::nullopt;
  if (!picture || !to_radiance(picture->linear, scale, *name, root.diagnostics())) return false;
  draft.environment = std::make_shared<const EnvironmentMap>(
      EnvironmentMap{.name = clean_text(*name),
                     .width = picture->width,
                     .height = picture->height,
                     .rgb = std::move(picture->linear),
                     .rotation_rad = rotation});
  return true;
}

}  // namespace raykiln::render::io
