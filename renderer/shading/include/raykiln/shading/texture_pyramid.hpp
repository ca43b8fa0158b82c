// Smaller copies of pictures, for reading a texture by how much of it a path's pixel covers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "raykiln/scene/surface_textures.hpp"
#include "raykiln/shading/made_once.hpp"

namespace raykiln::render {

/// How textures are read: at the point that a path meets, or as the mean over what its pixel covers there,
/// which takes noise from distant textures for a bias that no number of samples cures.
enum class TextureReading : std::uint8_t { kExact, kFootprint };

/// The next smaller picture: half as wide and high, rounded down, at least 1. Each texel is the mean of what it
/// covers, by area, of linear values, or of the bytes themselves where they are `data`.
[[nodiscard]] TextureImage halved(const TextureImage& image, bool data);
/// Nothing once stop is requested: asked for at every row.
[[nodiscard]] std::optional<TextureImage> halved(const TextureImage& image, bool data, const std::stop_token& stop);

/// The smaller copies of all pictures that materials multiply their surfaces with (not of emission or coverage, which
/// are read exactly), down to one texel. Made on the first demand, once, by whichever thread asks.
class TexturePyramids {
 public:
  /// Null: of nothing. `textures` outlives this.
  explicit TexturePyramids(const SurfaceTextures* textures);

  /// Of all of them, made or not.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  /// Makes them, if no one has. False once stop is requested; the copies made by then are kept.
  bool make(const std::stop_token& stop = {}) const;

  /// Value of the picture at (u, v) as the mean over squares of 2^level texels: between two copies, as `use`
  /// filters within each. The exact one where level <= 0. Precondition: make(), and a use by a material.
  [[nodiscard]] Rgbd value(const TextureUse& use, double u, double v, double level) const;

 private:
  struct Pyramid {
    std::vector<TextureImage> copies;  ///< the largest first; halved() of it each
    bool wanted = false;
  };
  [[nodiscard]] static std::size_t index_of(const TextureUse& use) { return 2 * std::size_t{use.image} + (use.data ? 1 : 0); }

  /// Adds to the copies of a picture what they lack.
  [[nodiscard]] static bool go_on(const TextureImage& image, bool data, std::vector<TextureImage>& copies,
                                  const std::stop_token& stop);

  struct OnDemand {
    MadeOnce made;
    std::vector<Pyramid> pyramids;  ///< two a picture: as colours and as numbers
  };
  const SurfaceTextures* textures_;
  std::unique_ptr<OnDemand> on_demand_;
  std::size_t bytes_ = 0;
};

}  // namespace raykiln::render
