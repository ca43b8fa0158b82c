// The film: per pixel sums, moments and counters, folded block by block.
#pragma once

#include <array>
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
  std::uint64_t index = 0;  ///< 0, 1, 2, ...; see replicate_of()
  std::uint64_t first = 0;  ///< first sample index
  std::uint64_t count = 0;  ///< samples rendered; less than the full block for the last of a job
  bool complete = true;     ///< false: kept apart by the film, rendered anew if the job is extended
};

/// The block with this index, whole.
[[nodiscard]] SampleBlock sample_block(std::uint64_t index);

/// All blocks that cover samples [0, samples), the last one cut short where it must be.
[[nodiscard]] std::vector<SampleBlock> blocks_for(std::uint64_t samples);

inline constexpr int kReplicates = 4;

/// The replicate that a block belongs to: samples 16 j .. 16 j + 15 are of replicate j mod 4, so that after
/// every 64 samples all replicates hold as many, and 2^k of them after 2^(k+2). Samplers whose points fill
/// space together randomise each replicate by itself.
[[nodiscard]] std::size_t replicate_of(std::uint64_t block_index);

/// How samples of one pixel depend on each other.
enum class SampleRelation : std::uint8_t {
  kIndependent,   ///< all of them are independent
  kByReplicates,  ///< those of one replicate are placed together; only replicates are independent
};

/// How a plane of two pieces of work becomes one. Moments are merged after Chan, Golub & LeVeque
/// (1979, eq. 1.5b): sums of squared deviations about their own means, never differences of squares.
enum class Fold : std::uint8_t { kSum, kMax, kMoments };

/// One plane: `channels` values a pixel, interleaved, row-major.
struct PlaneSpec {
  std::string_view name;
  int channels;
  Fold fold;
};

/// The planes of a block, in the order of PlaneSet::planes.
struct BlockPlane {
  enum Index : std::size_t {
    kBeauty,            ///< 3 channels: sums of RGB radiance over the samples that count
    kSamples,           ///< samples that count: rendered and finite
    kLuminanceMoment,   ///< sum of squared deviations of luminance from its mean in this block
    kMoment,            ///< 3 channels: the same of each channel
    kLargest,           ///< largest luminance of a sample (0 when there is none)
    kNan,               ///< samples dropped because a channel was NaN
    kInf,               ///< samples dropped because a channel did not fit a float32
    kNegative,          ///< samples with a negative channel (they count)
    kTruncated,         ///< samples whose path was cut at max_depth while it could go on
    kCount
  };
};
[[nodiscard]] std::span<const PlaneSpec> block_planes();

/// The planes of a film, by name: those of a block, and luminance_count and luminance_sum with one
/// channel for each replicate.
[[nodiscard]] std::span<const PlaneSpec> film_planes();

struct PlaneSet {
  std::vector<std::vector<double>> planes;  ///< one for each of block_planes()
};

/// Planes of zeros for so many pixels.
[[nodiscard]] PlaneSet make_block_planes(std::size_t pixels);

/// Adds one sample to pixel `pixel` of a block. A sample with a channel that is NaN or beyond
/// float32 is dropped and counted. Returns false when it was dropped. Call in order of sample.
bool add_sample(PlaneSet& block, std::size_t pixel, const Rgbd& radiance, bool truncated);

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

/// All that a film knows of a pixel: sums over the samples that count.
struct PixelSums {
  struct Counts {
    std::uint32_t nan = 0, inf = 0, negative = 0, truncated = 0;
  };
  std::array<double, 3> beauty{};   ///< sums of RGB radiance
  double luminance_moment = 0.0;    ///< sum of squared deviations of luminance from its mean
  std::array<double, 3> moment{};   ///< the same of each channel
  double largest = 0.0;             ///< largest luminance of a sample
  Counts counts;
  std::array<double, kReplicates> luminance_sum{};
  std::array<std::uint32_t, kReplicates> luminance_count{};

  [[nodiscard]] std::uint64_t samples() const;
};

/// Not thread-safe; one owner folds and reads.
class Film {
 public:
  Film(int width, int height, SampleRelation relation = SampleRelation::kIndependent);

  /// Bytes that a film of one pixel takes, the room for an incomplete last block included.
  [[nodiscard]] static std::size_t bytes_per_pixel();

  /// Folds a block of a tile into its pixels. Blocks of a pixel must come in order of index; the
  /// caller sees to it. An incomplete block is kept apart until another block of the pixel comes
  /// (the same index again, whole or longer), which replaces it. Throws std::invalid_argument when
  /// tile or planes do not fit this film: a broken promise, not an input.
  void fold(const PixelRect& tile, const BlockResult& block);

  /// Forgets the incomplete last blocks: every pixel is at the border of a block, as before they came.
  void drop_incomplete() { tails_.clear(); }

  /// Mean of all samples so far; black where there are none.
  [[nodiscard]] Image resolve() const;

  /// The same for these pixels alone, into a picture of the film's size that holds the rest already:
  /// who does so after each fold has a whole picture at any time without reading the whole film.
  void resolve(const PixelRect& part, Image& into) const;

  /// A plane of film_planes() over the whole film with the incomplete blocks folded in; empty when
  /// there is no plane of that name.
  [[nodiscard]] std::vector<double> plane(std::string_view name) const;

  /// One pixel, its incomplete block folded in. Index: y * width + x.
  [[nodiscard]] PixelSums pixel(std::size_t index) const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// What a variance may be taken from: all samples, or replicates alone.
  [[nodiscard]] SampleRelation relation() const { return relation_; }

 private:
  /// What a pixel holds of one block.
  struct Tail {
    std::array<double, 3> beauty{};
    double luminance_moment = 0.0;
    std::array<double, 3> moment{};
    double largest = 0.0;
    PixelSums::Counts counts;
    std::uint32_t samples = 0;
    std::uint32_t replicate = 0;
  };

  static Tail read_block(const BlockResult& block, std::size_t pixel);
  static void fold_pixel(PixelSums& into, const Tail& from);

  int width_, height_;
  SampleRelation relation_;
  std::vector<PixelSums> pixels_;
  std::vector<Tail> tails_;  ///< the incomplete last blocks; empty until there is one
};

}  // namespace raykiln::render
