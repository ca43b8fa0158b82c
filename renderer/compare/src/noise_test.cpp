#include "raykiln/compare/noise_test.hpp"

#include <algorithm>
#include <cmath>

#include "block_sums.hpp"
#include "channel_difference.hpp"
#include "tail.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kMostRegions = 16;
constexpr std::size_t kMostCandidates = 4096;  ///< of a level and channel, the largest |z|
constexpr int kLeastSideByDifferences = 8;  ///< pixels: |z| <= sqrt(pixels) when divided by differences
constexpr double kLeastDegrees = 4.0;  ///< below, the chi-square of a structure test is a guess

/// How the chances are shared out: equal parts for each channel and each kind and size of test, and
/// equal parts for all blocks of one size.
struct Family {
  double shares = 1.0;  ///< channels x (sizes of blocks + sizes of structure)
  double false_alarms = 0.0;
  bool symmetric = false;  ///< both pictures have equal sample counts, so that signs are fair
};

bool equal_counts(const MeasuredImage& a, const MeasuredImage& b) {
  constexpr double kAlike = 1.25;
  double of_a = 0.0, of_b = 0.0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    of_a += static_cast<double>(a.samples[i]);
    of_b += static_cast<double>(b.samples[i]);
  }
  return of_a <= kAlike * of_b && of_b <= kAlike * of_a;
}

/// Sizes 1, 2, 4, ... up to the first that covers the picture.
int block_sizes(int width, int height) {
  int sizes = 1;
  for (int side = 1; side < std::max(width, height); side *= 2) ++sizes;
  return sizes;
}

class ChannelTest {
 public:
  ChannelTest(const ChannelDifference& difference, int channel, const Family& family, NoiseVerdict& verdict)
      : width_(difference.width), height_(difference.height), channel_(channel), family_(family),
        verdict_(verdict) {}

  void run(CellGrid grid, bool structure) {
    judge_blocks(grid, 1);
    while (grid.columns > 1 || grid.rows > 1) {
      judge_blocks(overlapping_blocks(grid), grid.side_px);
      grid = coarser(grid);
      if (structure) judge_structure(grid);
    }
  }
  [[nodiscard]] std::vector<Evidence>& candidates() { return candidates_; }

 private:
  void note(const Evidence& evidence) {
    const auto stronger = [](const Evidence& a, const Evidence& b) {
      return a.family_chance < b.family_chance ||
             (a.family_chance <= b.family_chance && std::abs(a.z) > std::abs(b.z));
    };
    if (verdict_.strongest.kind == EvidenceKind::kNone || stronger(evidence, verdict_.strongest)) {
      verdict_.strongest = evidence;
    }
  }

  [[nodiscard]] PixelRect rect(int column, int row, int stride_px, int side_px) const {
    const int x0 = column * stride_px, y0 = row * stride_px;
    return {x0, y0, std::min(width_, x0 + side_px), std::min(height_, y0 + side_px)};
  }

  /// Neighbouring blocks begin `stride_px` apart.
  void judge_blocks(const CellGrid& blocks, int stride_px) {
    // Large blocks of pictures with equal counts have two normalisers, the smaller of which counts: error
    // layers err on the large side where tails are heavy, the differences do not.
    const bool by_differences = family_.symmetric && blocks.side_px >= kLeastSideByDifferences;
    const double count = static_cast<double>(blocks.cells.size()) * (by_differences ? 2.0 : 1.0);
    verdict_.tests += blocks.cells.size();
    const double least = sign_sum_quantile(std::min(0.5, family_.false_alarms / (family_.shares * count)));
    std::vector<Evidence> found;
    Evidence strongest;
    for (int row = 0; row < blocks.rows; ++row) {
      for (int column = 0; column < blocks.columns; ++column) {
        const double z = blocks.at(column, row).z(by_differences);
        if (std::abs(z) <= std::abs(strongest.z) && std::abs(z) < least) continue;
        Evidence evidence{.kind = kind_of(blocks),
                          .where = rect(column, row, stride_px, blocks.side_px),
                          .block_px = blocks.side_px,
                          .channel = channel_,
                          .z = z,
                          .family_chance = 1.0};
        if (std::abs(z) > std::abs(strongest.z)) strongest = evidence;
        if (std::abs(z) >= least) found.push_back(evidence);
      }
    }
    if (strongest.kind == EvidenceKind::kNone) return;
    const auto chance = [&](double z) { return std::min(1.0, sign_sum_two_sided(z) * count * family_.shares); };
    strongest.family_chance = chance(strongest.z);
    note(strongest);
    keep(std::move(found), chance);
  }

  template <class Chance>
  void keep(std::vector<Evidence> found, const Chance& chance) {
    const auto larger = [](const Evidence& a, const Evidence& b) { return std::abs(a.z) > std::abs(b.z); };
    if (found.size() > kMostCandidates) {
      std::nth_element(found.begin(), found.begin() + kMostCandidates, found.end(), larger);
      found.resize(kMostCandidates);
    }
    for (Evidence& evidence : found) evidence.family_chance = chance(evidence.z);
    candidates_.insert(candidates_.end(), found.begin(), found.end());
  }

  /// Sum over cells of (sum of e)^2 - sum of e^2: products of different pixels, of expectation 0. Given
  /// |e|, fair signs make its variance 2 sum of ((sum of e^2)^2 - sum of e^4); chi-square with matched
  /// moments (Satterthwaite 1946).
  void judge_structure(const CellGrid& grid) {
    ++verdict_.tests;
    double total = 0.0, expected = 0.0, variance = 0.0;
    for (const BlockSum& cell : grid.cells) {
      total += cell.sum * cell.sum;
      expected += cell.squares;
      variance += 2.0 * std::max(0.0, cell.squares * cell.squares - cell.fourths);
    }
    if (!(variance > 0.0)) return;
    const double degrees = 2.0 * expected * expected / variance;
    if (degrees < kLeastDegrees) return;
    const double chance = chi_square_above(total / expected, degrees) * family_.shares;
    note({.kind = EvidenceKind::kStructure,
          .where = {0, 0, width_, height_},
          .block_px = grid.side_px,
          .channel = channel_,
          .z = (total - expected) / std::sqrt(variance),
          .family_chance = std::min(1.0, chance)});
  }

  [[nodiscard]] static EvidenceKind kind_of(const CellGrid& blocks) {
    if (blocks.side_px == 1) return EvidenceKind::kPixel;
    return blocks.cells.size() == 1 ? EvidenceKind::kWhole : EvidenceKind::kBlock;
  }

  int width_, height_, channel_;
  const Family& family_;
  NoiseVerdict& verdict_;
  std::vector<Evidence> candidates_;
};

std::vector<double> tolerated_change(const MeasuredImage& reference, int channel, double tolerance) {
  std::vector<double> change;
  if (!(tolerance > 0.0)) return change;
  change.reserve(reference.pixels());
  for (std::size_t i = static_cast<std::size_t>(channel); i < reference.mean.rgb.size(); i += 3) {
    const double value = std::abs(static_cast<double>(reference.mean.rgb[i]));
    change.push_back(std::isfinite(value) ? tolerance * value : 0.0);
  }
  return change;
}

/// Figures of the whole picture; returns (sum of z^2, pixels with noise).
std::pair<double, double> measure_shift(const ChannelDifference& d, const MeasuredImage& reference,
                                        std::size_t channel, bool symmetric, double found_at,
                                        NoiseVerdict& verdict) {
  double sum = 0.0, light = 0.0, variance = 0.0, squares = 0.0, chi2 = 0.0, noisy = 0.0;
  for (std::size_t i = 0; i < d.difference.size(); ++i) {
    const double value = static_cast<double>(reference.mean.rgb[3 * i + channel]);
    sum += d.weight[i] * d.difference[i];
    light += d.weight[i] * (std::isfinite(value) ? std::abs(value) : 0.0);
    variance += d.weight[i] * d.weight[i] * d.variance[i];
    squares += d.weight[i] * d.weight[i] * d.difference[i] * d.difference[i];
    if (!(d.variance[i] > 0.0)) continue;
    chi2 += d.difference[i] * d.difference[i] / d.variance[i];
    noisy += 1.0;
  }
  if (symmetric && squares > 0.0) variance = std::min(variance, squares);
  if (light > 0.0) {
    verdict.shift[channel] = sum / light;
    verdict.shift_error[channel] = std::sqrt(variance) / light;
    const double least = found_at * verdict.shift_error[channel];
    const double known = verdict.smallest_uniform_change;  // 0 until a channel has light
    if (!(known > 0.0) || least < known) verdict.smallest_uniform_change = least;
  }
  return {chi2, noisy};
}

void count_not_finite(const MeasuredImage& render, const MeasuredImage& reference, NoiseVerdict& verdict) {
  const auto finite = [](const Image& image, std::size_t pixel) {
    return std::isfinite(image.rgb[3 * pixel]) && std::isfinite(image.rgb[3 * pixel + 1]) &&
           std::isfinite(image.rgb[3 * pixel + 2]);
  };
  for (std::size_t i = 0; i < render.pixels(); ++i) {
    const bool a = finite(render.mean, i), b = finite(reference.mean, i);
    verdict.render_not_finite += a ? 0U : 1U;
    verdict.reference_not_finite += b ? 0U : 1U;
    if (a != b) verdict.differs = true;
  }
}

bool overlap(const PixelRect& a, const PixelRect& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

/// The clearest blocks first, each apart from those before it.
void choose_regions(std::vector<Evidence> candidates, NoiseVerdict& verdict) {
  std::sort(candidates.begin(), candidates.end(),
            [](const Evidence& a, const Evidence& b) { return std::abs(a.z) > std::abs(b.z); });
  for (const Evidence& candidate : candidates) {
    if (verdict.regions.size() == kMostRegions) return;
    const bool apart = std::none_of(verdict.regions.begin(), verdict.regions.end(), [&](const Evidence& chosen) {
      return overlap(chosen.where, candidate.where);
    });
    if (apart) verdict.regions.push_back(candidate);
  }
}

}  // namespace

const char* name(EvidenceKind kind) {
  switch (kind) {
    case EvidenceKind::kPixel: return "pixel";
    case EvidenceKind::kBlock: return "block";
    case EvidenceKind::kWhole: return "whole";
    case EvidenceKind::kStructure: return "structure";
    case EvidenceKind::kNone: break;
  }
  return "none";
}

NoiseVerdict test_noise(const MeasuredImage& render, const MeasuredImage& reference,
                        const NoiseTestSettings& settings) {
  NoiseVerdict verdict;
  count_not_finite(render, reference, verdict);
  const int sizes = block_sizes(render.mean.width, render.mean.height);
  const bool structure = !(settings.tolerance > 0.0);
  const Family family{.shares = 3.0 * (sizes + (structure ? sizes - 1 : 0)),
                      .false_alarms = settings.false_alarms,
                      .symmetric = equal_counts(render, reference)};
  const double whole_found_at = sign_sum_quantile(std::min(0.5, family.false_alarms / family.shares / 2.0));
  std::vector<Evidence> candidates;
  double chi2 = 0.0, noisy = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    const ChannelDifference difference = channel_difference(render, reference, channel);
    ChannelTest test(difference, channel, family, verdict);
    test.run(pixel_cells(difference, tolerated_change(reference, channel, settings.tolerance)), structure);
    candidates.insert(candidates.end(), test.candidates().begin(), test.candidates().end());
    const auto [sum, count] =
        measure_shift(difference, reference, static_cast<std::size_t>(channel), family.symmetric, whole_found_at,
                      verdict);
    chi2 += sum;
    noisy += count;
  }
  verdict.chi2 = noisy > 0.0 ? chi2 / noisy : 0.0;
  verdict.differs = verdict.differs || verdict.strongest.family_chance <= settings.false_alarms;
  choose_regions(std::move(candidates), verdict);
  return verdict;
}

}  // namespace raykiln::render
