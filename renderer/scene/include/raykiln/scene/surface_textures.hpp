// Pictures on surfaces: colour and emission that change from point to point.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "raykiln/scene/metallic_roughness.hpp"

namespace raykiln::render {

inline constexpr std::uint32_t kNoTexture = 0xFFFFFFFFU;
inline constexpr std::uint32_t kNoUv = 0xFFFFFFFFU;

/// What lies beyond the edges of a picture.
enum class TextureWrap : std::uint8_t { kRepeat, kMirror, kClamp };
enum class TextureFilter : std::uint8_t { kBilinear, kNearest };

/// Three values a texel, or one, row 0 at the top. One of the two is filled.
struct TextureImage {
  std::string name;  ///< of the file, or where it is embedded
  int width = 0, height = 0;
  std::vector<std::uint8_t> srgb8;  ///< sRGB display values
  std::vector<float> linear;        ///< linear values, finite, >= 0
  int channels = 3;                 ///< or 1, of coverage: all three values are that one
};

/// A picture as a material uses it. Its coordinates are u' = u_row . (u, v, 1) and v' likewise;
/// (0, 0) is the top left corner of the picture, (1, 1) the bottom right one.
struct TextureUse {
  std::uint32_t image = kNoTexture;
  std::uint8_t uv_set = 0;
  TextureWrap wrap_u = TextureWrap::kRepeat, wrap_v = TextureWrap::kRepeat;
  TextureFilter filter = TextureFilter::kBilinear;
  bool data = false;  ///< numbers, not colours: bytes are not sRGB
  Vec3d u_row{1.0, 0.0, 0.0}, v_row{0.0, 1.0, 0.0};

  [[nodiscard]] bool used() const { return image != kNoTexture; }
};

/// What the textures of one material multiply. The material holds the values of a white texture.
struct MaterialTextures {
  TextureUse base;         ///< multiplies diffuse, what goes through facets, and the tinted share of specular
  Rgb specular_tint{0.0F}; ///< that share, [0, 1] for each channel
  TextureUse emission;     ///< multiplies emission
  TextureUse roughness;    ///< of facets: green multiplies roughness, blue metallic
  MetallicRoughness metal; ///< what those and `through` are multiplied with
  TextureUse normal;       ///< half of 1 + the normal in the frame of the picture, y upwards in it
  double normal_scale = 1.0;  ///< of its x and y
  TextureUse through;         ///< of facets: multiplies the share of diffuse transmission
  TextureUse through_colour;  ///< of facets: multiplies its colour
  TextureUse alpha;           ///< multiplies coverage
  std::optional<double> alpha_cutoff{};  ///< the product counts as 0 below it and as 1 from it on

  [[nodiscard]] std::array<TextureUse*, 7> uses() {
    return {&base, &emission, &roughness, &normal, &through, &through_colour, &alpha};
  }
  [[nodiscard]] std::array<const TextureUse*, 7> uses() const {
    return {&base, &emission, &roughness, &normal, &through, &through_colour, &alpha};
  }
  [[nodiscard]] bool used() const {
    const auto all = uses();
    return std::any_of(all.begin(), all.end(), [](const TextureUse* use) { return use->used(); });
  }
};

struct UvSet {
  std::vector<Vec2f> coordinates;
  /// Indices into coordinates, kNoUv where a corner has none; triangles beyond its end have none.
  std::vector<std::array<std::uint32_t, 3>> corners;
};

struct SurfaceTextures {
  std::vector<TextureImage> images;
  std::vector<MaterialTextures> materials;  ///< one a material; those beyond its end have none
  std::array<UvSet, 2> uv_sets;
};

}  // namespace raykiln::render
