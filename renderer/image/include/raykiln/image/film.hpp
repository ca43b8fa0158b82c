// The film: per pixel sums, moments and counters in double, folded block by block.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "raykiln/math/vec.hpp"

namespace raykiln::render {

/// Pixels x0 <= x < x1, y0 <= y < y1; row 0 is at the top.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int height() const { return y1 - y0; }
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
};

/// A range of sample indices, rendered and folded as one. Borders are 0, 1, 2, 4, 8, 16 and then
/// every 16: a function of the index alone, so that the sums do not depend on how work was cut.
struct SampleBlock {
  std::uint64_t index = 0;  ///< 0, 1, 2, ...; belongs to replicate index mod 8
  std::uint64_t first = 0;  ///< first sample index
  std::uint64_t count = 0;  ///< samples rendered; less than the full block for the last of a job
  bool complete = true;     ///< false: kept apart by the film, rendered anew if the job is extended
};

/// The block with this index, whole.
[[nodiscard]] SampleBlock sample_block(std::uint64_t index);

/// All blocks that cover samples [0, samples), the last one cut short where it must be.
[[nodiscard]] std::vector<SampleBlock> blocks_for(std::uint64_t samples);

inline constexpr int kReplicates = 8;

enum class Fold : std::uint8_t { kSum, kMax };

/// What one plane of film or block holds: `channels` doubles a pixel, interleaved, row-major.
struct PlaneSpec {
  std::string_view name;
  int channels;
  Fold fold;
};

/// beauty(3 sums), samples(1), luminance(per replicate: count, sum, sum of squared deviations
/// ...), largest(1 max), nan, inf, negative, truncated (1 each). See film.cpp for the exact list.
[[nodiscard]] std::span<const PlaneSpec> film_planes();

struct PlaneSet {
  std::vector<std::vector<double>> planes;  ///< one for each of film_planes()
};

struct BlockResult {
  SampleBlock block;
  PlaneSet planes;  ///< over the pixels of the tile
};

/// A sample whose value was not finite, so that exactly this one can be rendered again.
struct BadSample {
  int x = 0, y = 0;
  std::uint64_t sample = 0;
};

/// Linear RGB, 3 floats a pixel, row-major, row 0 at the top.
struct Image {
  int width = 0, height = 0;
  std::vector<float> rgb;
};

class Film {
 public:
  Film(int width, int height);

  /// Bytes that a film of one pixel takes, the room for an incomplete last block included.
  [[nodiscard]] static std::size_t bytes_per_pixel();

  /// Folds a block of a tile into its pixels. Blocks of a pixel must come in order of index; the
  /// caller sees to it. An incomplete block is kept apart and replaced by a later one of the same index.
  void fold(const PixelRect& tile, const BlockResult& block);

  /// Mean of all samples so far; black where there are none.
  [[nodiscard]] Image resolve() const;

  /// A plane over the whole film with the incomplete block folded in.
  [[nodiscard]] std::vector<double> plane(std::string_view name) const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

 private:
  int width_, height_;
  PlaneSet folded_;
  PlaneSet tail_;  ///< the incomplete last blocks; empty until there is one
};

}  // namespace raykiln::render
