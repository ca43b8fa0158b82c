#include "windows.hpp"

#include <algorithm>

namespace raykiln::render {
namespace {

/// Sums along one row or column. Each is added up anew: a running difference would keep the rounding
/// of what has passed.
template <typename In, typename Out>
void slide(int length, int radius, In in, Out out) {
  for (int i = 0; i < length; ++i) {
    double sum = 0.0;
    for (int k = std::max(0, i - radius); k <= std::min(length - 1, i + radius); ++k) sum += in(k);
    out(i) = sum;
  }
}

int within(int at, int length, int radius) {
  return std::min(length - 1, at + radius) - std::max(0, at - radius) + 1;
}

}  // namespace

std::vector<double> Windows::sums(const std::vector<double>& values) const {
  const auto w = static_cast<std::size_t>(width);
  std::vector<double> rows(values.size()), result(values.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    slide(
        width, radius, [&](int x) { return values[y * w + static_cast<std::size_t>(x)]; },
        [&](int x) -> double& { return rows[y * w + static_cast<std::size_t>(x)]; });
  }
  for (std::size_t x = 0; x < w; ++x) {
    slide(
        height, radius, [&](int y) { return rows[static_cast<std::size_t>(y) * w + x]; },
        [&](int y) -> double& { return result[static_cast<std::size_t>(y) * w + x]; });
  }
  return result;
}

double Windows::count(std::size_t pixel) const {
  const auto w = static_cast<std::size_t>(width);
  return static_cast<double>(within(static_cast<int>(pixel % w), width, radius) *
                             within(static_cast<int>(pixel / w), height, radius));
}

std::vector<double> Windows::means_of_others(const std::vector<double>& values) const {
  std::vector<double> means = sums(values);
  for (std::size_t i = 0; i < means.size(); ++i) {
    means[i] = (means[i] - values[i]) / std::max(1.0, count(i) - 1.0);
  }
  return means;
}

}  // namespace raykiln::render
