// Double sampling: a wide, cheap sample of single pixels says how the noise is spread over the picture, and places
// that are judged in full say what it amounts to (Cochran 1977, "Sampling techniques", 6.4 and 12.5).
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "figures.hpp"

namespace raykiln::render {
namespace {

constexpr int kPatchSide = 12;
/// Half of what regions need: intervals of single patches matter less than how patches differ.
constexpr int kPatchMargin = kRegionMargin / 2;
constexpr int kPatches = 42;       ///< about so many, one in each part of the picture
constexpr double kScouts = 6000;  ///< single pixels, at most about so many
constexpr std::uint64_t kWholePixels = 12 * 1024;  ///< pictures of fewer are judged as a whole

/// SplitMix64's mixing of bits (Steele, Lea & Flood 2014): where in its part of the picture something is taken.
std::uint64_t mixed(std::uint64_t z) {
  z = (z + 0x9E3779B97F4A7C15ULL) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 29U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 32U);
}

/// For the squares of a pixel (relative, linear, display): what can be had without its neighbours.
using StandIns = std::array<double, 3>;

/// What is kept of a single pixel until the mean of all is known.
struct Scout {
  double mean, variance;  ///< of the mean; of its channels, and their sum
  explicit Scout(const PixelStatistics& p)
      : mean((p.mean[0] + p.mean[1] + p.mean[2]) / 3.0), variance(p.variance[0] + p.variance[1] + p.variance[2]) {}
};

/// The variance in the denominator keeps pixels that are dark by chance from having all the say.
StandIns stand_ins(const Scout& p, double mean) {
  const double square = p.mean * p.mean + p.variance;
  return {p.variance / (square + 0.01 * mean * mean), p.variance, p.variance / (std::sqrt(square) + 0.1 * mean)};
}

/// Mean of a list and the relative variance of that mean. Neighbours in the list are neighbours in the picture, so
/// that half their squared differences say how a stratified sample scatters.
struct Average {
  double mean = 0.0, relative_variance = 0.0;
};
Average average(const std::vector<StandIns>& scouts, std::size_t kind, double share) {
  const auto n = static_cast<double>(scouts.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < scouts.size(); ++i) {
    sum += scouts[i][kind];
    const double step = i > 0 ? scouts[i][kind] - scouts[i - 1][kind] : 0.0;
    squares += step * step;
  }
  if (!(sum > 0.0)) return {};
  return {sum / n, (1.0 - share) * squares / (2.0 * (n - 1.0)) * n / (sum * sum)};
}

/// A patch: squares as judged, and the stand-ins of the same pixels.
struct Patch {
  std::array<Tally, 3> judged;
  StandIns stand_in{};
  double tails = 0.0;
};

Patch judge(const Film& film, const PixelRect& core, const Survey& survey, double gain) {
  Totals totals;
  add_region(totals, film, core, kPatchMargin, survey, gain);
  Patch patch{.judged = {totals.relative, totals.linear, totals.display}, .tails = totals.tails};
  for (int y = core.y0; y < core.y1; ++y) {
    for (int x = core.x0; x < core.x1; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width()) + static_cast<std::size_t>(x);
      const StandIns of = stand_ins(Scout(pixel_statistics(film, i)), survey.mean());
      for (std::size_t k = 0; k < of.size(); ++k) patch.stand_in[k] += of[k];
    }
  }
  return patch;
}

/// The ratio of what patches are judged at to their stand-ins, times the stand-ins of the whole picture.
Square whole(const std::vector<Patch>& patches, const std::vector<StandIns>& scouts, std::size_t kind, double patch_share,
             double scout_share) {
  double judged = 0.0, stood_in = 0.0, noise = 0.0, squares = 0.0;
  for (const Patch& p : patches) {
    judged += p.judged[kind].sum;
    stood_in += p.stand_in[kind];
    noise += p.judged[kind].variance;
  }
  const Average scouted = average(scouts, kind, scout_share);
  if (!(judged > 0.0 && stood_in > 0.0 && scouted.mean > 0.0)) return {};
  const double ratio = judged / stood_in;
  for (const Patch& p : patches) {
    const double residual = p.judged[kind].sum - ratio * p.stand_in[kind];
    squares += residual * residual;
  }
  const auto n = static_cast<double>(patches.size());
  const double of_ratio = (1.0 - patch_share) * squares * n / (n - 1.0) / (judged * judged);
  const double of_noise = patch_share * noise / (judged * judged);
  return {ratio * scouted.mean / 3.0, of_ratio + scouted.relative_variance + of_noise};
}

/// visit(part, number) for each part of a grid of about so many, all of nearly the same size and shape.
template <typename Visit>
void in_parts(int width, int height, double parts, Visit visit) {
  const double side = std::sqrt(double{1} * width * height / parts);
  const auto cuts = [side](int length) { return std::clamp(static_cast<int>(length / side + 0.5), 1, length); };
  const int across = cuts(width), down = cuts(height);
  const auto border = [](int i, int cut, int length) { return static_cast<int>(std::int64_t{i} * length / cut); };
  std::uint64_t number = 0;
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      visit(PixelRect{border(x, across, width), border(y, down, height), border(x + 1, across, width),
                      border(y + 1, down, height)},
            ++number);
    }
  }
}

/// Where in [begin, end) something of this length begins; it may reach beyond the end, not beyond `most`.
int place(int begin, int end, int length, int most, std::uint64_t bits) {
  const int at = begin + static_cast<int>(bits % static_cast<std::uint64_t>(end - begin)) - length / 2;
  return std::clamp(at, 0, most - length);
}

}  // namespace

ImageError quick_image_error(const Film& film, double exposure_stops) {
  const int w = film.width(), h = film.height();
  const auto pixels = static_cast<std::uint64_t>(w) * static_cast<std::uint64_t>(h);
  if (pixels <= kWholePixels || std::min(w, h) < 2 * kPatchSide) return image_error(film, exposure_stops);
  ImageError result;
  result.pixels = pixels;
  result.sampled = true;
  Survey survey;
  std::vector<Scout> seen;
  in_parts(w, h, kScouts, [&](const PixelRect& part, std::uint64_t number) {
    const std::uint64_t bits = mixed(number);
    const int x = place(part.x0, part.x1, 1, w, bits & 0xFFFFFFFFU), y = place(part.y0, part.y1, 1, h, bits >> 32U);
    const auto p = pixel_statistics(film, static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x));
    survey.add(p);
    seen.emplace_back(p);
  });
  if (!note_survey(result, survey)) return result;
  std::vector<StandIns> scouts;
  for (const Scout& p : seen) scouts.push_back(stand_ins(p, survey.mean()));
  std::vector<Patch> patches;
  in_parts(w, h, kPatches, [&](const PixelRect& part, std::uint64_t number) {
    const std::uint64_t bits = mixed(~number);
    const int x = place(part.x0, part.x1, kPatchSide, w, bits & 0xFFFFFFFFU);
    const int y = place(part.y0, part.y1, kPatchSide, h, bits >> 32U);
    patches.push_back(judge(film, {x, y, x + kPatchSide, y + kPatchSide}, survey, std::exp2(exposure_stops)));
  });
  const double all = static_cast<double>(pixels), scout_share = static_cast<double>(scouts.size()) / all;
  const double patch_share = static_cast<double>(patches.size()) * kPatchSide * kPatchSide / all;
  double tails = 0.0, relative = 0.0;
  for (const Patch& p : patches) {
    tails += p.tails;
    relative += p.judged[0].sum;
  }
  const auto square = [&](std::size_t kind) { return whole(patches, scouts, kind, patch_share, scout_share); };
  set_figures(result, {square(0), square(1), square(2)}, relative > 0.0 ? tails / relative : 0.0);
  return result;
}

}  // namespace raykiln::render
