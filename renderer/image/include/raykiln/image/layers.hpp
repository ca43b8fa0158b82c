// Layers beside a picture: what the camera rays of a pixel meet, and the parts of its light.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Means over the samples of a pixel that count, unless said otherwise. What meets nothing adds 0. `emission`,
/// `direct` and `indirect` add up to the picture.
enum class Layer : std::uint8_t {
  kAlbedo,      ///< share of light that the surface sends on at normal incidence, textures included
  kNormal,      ///< shading normal, world space, towards the camera; shorter than 1 where normals differ
  kDepth,       ///< metres along the camera's axis, mean over what meets a surface; +inf where nothing does
  kObjectId,    ///< of the pixel's first sample: 1 + number of the object, 0 for nothing
  kMaterialId,  ///< of the pixel's first sample: 1 + number of the material, 0 for nothing
  kEmission,    ///< light of what the camera ray meets, or of the background
  kDirect,      ///< light that came to the first surface straight from where it is emitted
  kIndirect,    ///< the rest: light with more than one scattering
};
inline constexpr std::size_t kLayers = 8;

struct LayerSpec {
  std::string_view name;  ///< "albedo", ...
  std::size_t channels;   ///< 1 or 3
  std::array<std::string_view, 3> exr_channels;
};
[[nodiscard]] const LayerSpec& spec(Layer layer);
[[nodiscard]] std::optional<Layer> layer_named(std::string_view name);

class LayerSet {
 public:
  constexpr LayerSet() = default;
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  [[nodiscard]] bool contains(Layer layer) const { return (bits_ & bit(layer)) != 0; }
  void insert(Layer layer) { bits_ |= bit(layer); }
  friend bool operator==(const LayerSet&, const LayerSet&) = default;

 private:
  static std::uint32_t bit(Layer layer) { return std::uint32_t{1} << static_cast<unsigned>(layer); }
  std::uint32_t bits_ = 0;
};

/// "albedo,depth": names in any order. Nothing when one is unknown, empty or named twice; "" is no layer.
[[nodiscard]] std::optional<LayerSet> layer_set_of(std::string_view text);
/// The same in the order of Layer.
[[nodiscard]] std::string layer_set_text(const LayerSet& set);
[[nodiscard]] std::vector<Layer> layers_in(const LayerSet& set);
/// "albedo, normal, ...": all there are, for messages.
[[nodiscard]] std::string all_layer_names();

/// What one sample brings to the layers of its pixel.
struct LayerSample {
  bool met = false;  ///< the camera ray meets a surface; what is not light is 0 else
  Rgbd albedo{0.0};
  Vec3d normal{0.0};
  double depth = 0.0;
  std::uint32_t object = 0, material = 0;
  Rgbd emission{0.0}, direct{0.0}, indirect{0.0};
};

/// Sums over a block of samples, interleaved: sums_of(set) values a pixel of the tile.
struct LayerBlock {
  SampleBlock block;
  LayerSet set;
  std::vector<double> sums;
};
[[nodiscard]] std::size_t sums_of(const LayerSet& set);
[[nodiscard]] LayerBlock make_layer_block(const SampleBlock& block, const LayerSet& set, std::size_t pixels);
/// Adds sample number `sample`. One that does not count (its radiance is not finite) leaves its ids alone.
void add_sample(LayerBlock& block, std::size_t pixel, std::uint64_t sample, const LayerSample& value, bool counts);

/// Layers of a film, folded by the rules of Film::fold. Not thread-safe; one owner folds and reads.
class LayerFilm {
 public:
  LayerFilm(const LayerSet& set, int width, int height);

  /// Bytes a pixel, the room for an incomplete last block and for the resolved layers included.
  [[nodiscard]] static std::size_t bytes_per_pixel(const LayerSet& set);

  /// Throws std::invalid_argument when tile or sums do not fit: a broken promise, not an input.
  void fold(const PixelRect& tile, const LayerBlock& block);
  void drop_incomplete() { tails_.clear(); }

  /// A film of the rows y0 <= y < y1 alone, to be resolved elsewhere while this one is folded into.
  [[nodiscard]] LayerFilm rows(int y0, int y1) const;

  /// channels values a pixel. `samples`: those of the film that count, one a pixel.
  [[nodiscard]] std::vector<float> resolve(Layer layer, std::span<const float> samples) const;

  [[nodiscard]] const LayerSet& set() const { return set_; }

 private:
  LayerSet set_;
  int width_, height_;
  std::size_t stride_;
  std::vector<double> sums_;
  std::vector<double> tails_;  ///< of incomplete last blocks; empty until there is one
};

}  // namespace raykiln::render
