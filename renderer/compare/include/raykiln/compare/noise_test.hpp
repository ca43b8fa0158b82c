// Is the difference of two renders larger than their noise explains?
//
// Null hypothesis: both pictures are means of independent samples of the same radiance. The test looks
// at every pixel, at overlapping blocks of 2, 4, 8, ... pixels up to the whole picture, and at how
// much neighbouring pixels differ together, and holds the chance of any false alarm in a pair of
// pictures at or below `false_alarms`. README.md has the statistics and what they assume.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "raykiln/compare/measured_image.hpp"

namespace raykiln::render {

struct NoiseTestSettings {
  double false_alarms = 0.001;  ///< chance that two renders of one scene are called different, (0, 1)
  /// Changes of a block's mean up to this share of its brightness do not count; 0: any change does.
  /// Above 0 only blocks and pixels are judged, not how neighbours differ together.
  double tolerance = 0.0;
};

enum class EvidenceKind : std::uint8_t {
  kNone,
  kPixel,      ///< one pixel by itself
  kBlock,      ///< the mean over a block
  kWhole,      ///< the mean over the picture
  kStructure,  ///< pixels of a block differ together, over many blocks, each of them unremarkable
};
[[nodiscard]] const char* name(EvidenceKind kind);

/// One test of the family.
struct Evidence {
  EvidenceKind kind = EvidenceKind::kNone;
  PixelRect where;             ///< the whole picture for kStructure
  int block_px = 0;            ///< side of the blocks: 1, 2, 4, ...
  int channel = 0;             ///< 0 red, 1 green, 2 blue
  double z = 0.0;              ///< in standard deviations; positive: the render is brighter
  double family_chance = 1.0;  ///< chance, times the number of tests: compare with false_alarms
};

struct NoiseVerdict {
  bool differs = false;
  Evidence strongest;
  std::vector<Evidence> regions;  ///< blocks that differ, at most 16, none inside another
  std::uint64_t tests = 0;        ///< how many chances the family has
  double chi2 = 0.0;              ///< mean of z^2 over pixels and channels; 1 where only noise is, less if errors are cautious
  /// Weighted means over the picture, by channel: sum of w (render - reference) / sum of w reference.
  std::array<double, 3> shift{};
  std::array<double, 3> shift_error{};  ///< one standard deviation of it
  /// A uniform change of brightness of this share would have been found in half of such pairs.
  double smallest_uniform_change = 0.0;
  std::uint64_t render_not_finite = 0, reference_not_finite = 0;  ///< pixels; they differ if unlike
};

/// Both must have noise and the same size (precondition; see MeasuredImage::has_noise).
[[nodiscard]] NoiseVerdict test_noise(const MeasuredImage& render, const MeasuredImage& reference,
                                      const NoiseTestSettings& settings);

}  // namespace raykiln::render
