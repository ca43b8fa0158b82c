// Textures while a scene is being read.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics.hpp"
#include "raykiln/scene/surface_textures.hpp"

namespace raykiln::render::io {

/// Who names a picture: for errors.
struct PictureUser {
  std::string file;
  std::string where;
};

/// What a picture is read for. Colours are at most 1; emission may be anything, and is stored divided by
/// a power of two so that its values are at most 1, too. Data are numbers in [0, 1], bytes as they are.
/// Coverage is the picture's alpha, one value a texel; a picture that has none, or is opaque all over, is
/// no picture then. Opacity is the same, or where there is no alpha the brightness.
enum class PictureRole { kColour, kEmission, kData, kCoverage, kOpacity };

/// Pictures are decoded when a material names them, each once, whether that succeeds or not, within the
/// limits of the import.
class DraftTextures {
 public:
  bool allow_missing = false;  ///< what is missing or unreadable is left out with a warning

  /// Index of the picture that `reference`, written in `user.file`, means: kNoTexture where it is
  /// left out; nothing after an error, which names it.
  std::optional<std::uint32_t> beside(const SceneFiles& files, std::string_view reference,
                                      const PictureUser& user, PictureRole role,
                                      Diagnostics& diagnostics);
  /// The same for bytes that are embedded, unless known() has them; `name` is unique in the scene.
  std::optional<std::uint32_t> embedded(const std::string& name, std::string_view bytes,
                                        const PictureUser& user, PictureRole role,
                                        Diagnostics& diagnostics);
  /// What was read under this name before: kNoTexture where it was left out.
  [[nodiscard]] std::optional<std::uint32_t> known(const std::string& name, PictureRole role) const;
  /// What is to happen to a picture that cannot be had, for `reason`.
  std::optional<std::uint32_t> unusable(ImportErrorCode code, const std::string& reason,
                                        const PictureUser& user, Diagnostics& diagnostics);

  /// Textures of material `id`, made if there are none.
  MaterialTextures& of_material(std::uint32_t id);
  [[nodiscard]] bool any() const;

  /// Adds the coordinates of the triangle `id`, those before it without any.
  void add_corners(std::size_t set, std::size_t id, const std::array<std::uint32_t, 3>& corners);

  std::vector<TextureImage> images;
  std::vector<double> scales;  ///< one an image: the power of two its values were divided by
  std::vector<MaterialTextures> materials;
  std::array<UvSet, 2> uv_sets;

 private:
  std::optional<std::uint32_t> decode(const std::string& name, std::string_view bytes,
                                      const PictureUser& user, PictureRole role,
                                      Diagnostics& diagnostics);

  std::map<std::pair<std::string, PictureRole>, std::uint32_t> by_name_;
  std::uint64_t bytes_ = 0;  ///< of all decoded pictures
};

}  // namespace raykiln::render::io
