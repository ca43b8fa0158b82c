// How far a picture is from its limit of infinitely many samples, as figures with an interval.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// A value and the interval that holds the true one of this very picture in 95 % of all seeds.
struct Figure {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// What a figure is worth. One spelling everywhere: see name().
enum class ErrorGrade : std::uint8_t {
  kUnknown,   ///< a pixel has fewer than 2 samples, or the picture is black: no figure is valid
  kRough,     ///< a pixel has fewer than kSampleFloor samples: intervals may be too narrow
  kMeasured,
};
[[nodiscard]] std::string name(ErrorGrade grade);  ///< "unknown", "rough", "measured"

/// Samples of the poorest pixel from which on an error may end a job.
inline constexpr std::uint64_t kSampleFloor = 64;

/// x: a channel of a pixel of the picture, r: of the truth, M: the mean of r over pixels and channels.
struct ImageError {
  ErrorGrade grade = ErrorGrade::kUnknown;
  Figure rel_mse;       ///< mean over pixels and channels of (x - r)^2 / (r^2 + 0.01 M^2)
  Figure error;         ///< square root of rel_mse: "2 %" is rel_mse 4e-4
  Figure rmse;          ///< root of the mean of (x - r)^2; radiance
  Figure display_rmse;  ///< the same of display values in [0, 1] at the exposure that was given

  /// More than two fifths of rel_mse come from places where few samples make up the variance: it may
  /// be far larger than they show. Intervals grow with that part, from a fifth on, to three times as wide (in the
  /// logarithm) where it is four fifths.
  bool heavy_tailed = false;
  /// No two samples of any pixel differ. True of a picture without noise, and of one in which no
  /// sample has found the light: samples alone cannot tell.
  bool no_variance = false;
  /// Judged on a sample of the pixels, which the intervals include; counts are those of the sample then.
  bool sampled = false;

  std::uint64_t pixels = 0, unsampled_pixels = 0;  ///< unsampled: no sample at all
  std::uint64_t least_samples = 0;                 ///< of the poorest pixel
  double mean_samples = 0.0;
  double mean = 0.0;  ///< M, estimated
};

/// Noise alone: what samples cannot cure (truncated paths, approximations, light that no sample has
/// found) is not in it. A pure function of the film. Some 3 MB of working memory. `exposure_stops` is for display_rmse.
[[nodiscard]] ImageError image_error(const Film& film, double exposure_stops = 0.0);

/// The same from a sample of the pixels that depends on the size of the film alone, at a cost that does not grow with
/// it: for a picture that is looked at again and again while it is rendered. Below 12288 pixels (or 24 rows or columns) it is image_error().
[[nodiscard]] ImageError quick_image_error(const Film& film, double exposure_stops = 0.0);

/// Codes of what must be said beside the figures: "error_unknown", "error_rough", "error_sampled", "heavy_tailed",
/// "no_variance", "unsampled_pixels", and "aliasing_not_measured" when the pixel mode samples no area.
[[nodiscard]] std::vector<std::string> error_notices(const ImageError& error, bool samples_area);

/// Largest mean that light of which `samples` samples have found nothing can still add (95 %, rule of
/// three), when one sample can add at most `largest`.
[[nodiscard]] double unseen_bound(double largest, std::uint64_t samples);

}  // namespace raykiln::render
