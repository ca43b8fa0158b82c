// A render against its reference: by their noise where both carry it, else by thresholds.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "raykiln/compare/noise_test.hpp"
#include "raykiln/compare/threshold_test.hpp"

namespace raykiln::server {

struct ComparisonSettings {
  render::NoiseTestSettings noise;
  render::Thresholds thresholds;
  bool use_thresholds = false;  ///< even where the noise is known
};

enum class ComparisonMethod : std::uint8_t {
  kNone,        ///< it could not be done: unlike sizes, or a picture cannot be read
  kNoise,
  kThresholds,  ///< noise was not taken into account
};
[[nodiscard]] const char* name(ComparisonMethod method);

struct Comparison {
  ComparisonMethod method = ComparisonMethod::kNone;
  bool unreadable = false;  ///< one of the pictures is none; `reason` says which and why
  bool differs = true;
  std::string reason;       ///< one line for people, also when nothing differs
  int width = 0, height = 0;
  bool display_values = false;  ///< a PNG was there: figures and thresholds are of values in [0, 1]
  bool same_seed = false;       ///< the files say so
  ComparisonSettings settings;
  render::NoiseVerdict noise;             ///< of kNoise
  render::ThresholdVerdict thresholds;    ///< of kThresholds
  render::DifferenceFigures figures;
  std::vector<std::uint8_t> difference_png;
  std::vector<std::uint8_t> z_map_png;    ///< empty unless kNoise
};

using PictureBytes = std::span<const std::uint8_t>;

/// Reads both (EXR or PNG) and judges. `with_pictures`: fills the two PNGs.
[[nodiscard]] Comparison compare_pictures(PictureBytes render, PictureBytes reference,
                                          const ComparisonSettings& settings, bool with_pictures);

/// One object; the fields are described in server/app/README.md.
[[nodiscard]] std::string comparison_json(const Comparison& comparison);
/// A few lines for people.
[[nodiscard]] std::string comparison_text(const Comparison& comparison);

}  // namespace raykiln::server
