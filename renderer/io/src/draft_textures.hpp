// Textures while a scene is being read.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics.hpp"
#include "raykiln/scene/surface_textures.hpp"

namespace raykiln::render::io {

/// Who names a picture: for errors.
struct PictureUser {
  std::string file;
  std::string where;
};

/// Pictures are decoded when a material names them, each once, within the limits of the import.
class DraftTextures {
 public:
  bool allow_missing = false;  ///< what is missing or unreadable is left out with a warning

  /// Index of the picture that `reference`, written in `user.file`, means: kNoTexture where it is
  /// left out; nothing after an error, which names it.
  std::optional<std::uint32_t> beside(const SceneFiles& files, std::string_view reference,
                                      const PictureUser& user, Diagnostics& diagnostics);
  /// The same for bytes that are embedded; `key` is a name for them, unique in the scene.
  std::optional<std::uint32_t> embedded(const std::string& key, std::string_view bytes,
                                        const PictureUser& user, Diagnostics& diagnostics);
  /// What is to happen to a picture that cannot be had, for `reason`.
  std::optional<std::uint32_t> unusable(ImportErrorCode code, const std::string& reason,
                                        const PictureUser& user, Diagnostics& diagnostics);

  /// Textures of material `id`, made if there are none.
  MaterialTextures& of_material(std::uint32_t id);
  [[nodiscard]] bool any() const;

  /// Adds the coordinates of the triangle `id`, those before it without any.
  void add_corners(std::size_t set, std::size_t id, const std::array<std::uint32_t, 3>& corners);

  std::vector<TextureImage> images;
  std::vector<MaterialTextures> materials;
  std::array<UvSet, 2> uv_sets;

 private:
  std::map<std::string, std::uint32_t, std::less<>> by_key_;
  std::uint64_t bytes_ = 0;  ///< of all decoded pictures
};

}  // namespace raykiln::render::io
