#include "smoothed_means.hpp"

#include "noise_share.hpp"

namespace raykiln::render {
namespace {

template <typename Value>
std::vector<double> gather(std::span<const PixelStatistics> pixels, Value value) {
  std::vector<double> values;
  values.reserve(pixels.size());
  for (const PixelStatistics& p : pixels) values.push_back(value(p));
  return values;
}

/// Luminance without the largest sample.
double rest(const PixelStatistics& p) { return p.luminance - p.of_largest; }

/// Part of the largest sample in a pixel's mean, the same for all channels.
double part_of_largest(const PixelStatistics& p) {
  return p.luminance > 0.0 ? p.of_largest / p.luminance : 0.0;
}

}  // namespace

std::array<std::vector<double>, 3> smoothed_means(std::span<const PixelStatistics> pixels,
                                                  const Windows& windows) {
  const auto noise = [](const PixelStatistics& p) { return p.variance_without; };
  const auto shares = noise_shares(gather(pixels, rest), gather(pixels, noise), windows);
  const auto counts = windows.counts();
  std::array<std::vector<double>, 3> result;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto peak = [c](const PixelStatistics& p) { return p.mean[c] * part_of_largest(p); };
    const auto base = [&](const PixelStatistics& p) { return p.mean[c] - peak(p); };
    const auto peaks = windows.means_of_others(gather(pixels, peak));
    const auto bases = windows.means_of_others(gather(pixels, base));
    result[c].resize(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const double own = base(pixels[i]);
      result[c][i] = counts[i] < 2.0 ? pixels[i].mean[c]
                                            : own + shares[i] * (bases[i] - own) + peaks[i];
    }
  }
  return result;
}

}  // namespace raykiln::render
