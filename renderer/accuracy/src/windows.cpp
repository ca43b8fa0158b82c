#include "windows.hpp"

#include <algorithm>

namespace raykiln::render {
namespace {

/// into[x] += from[x + offset] wherever both are there.
void add_shifted(const double* from, double* into, int length, int offset) {
  const int begin = std::max(0, -offset), end = std::min(length, length - offset);
  for (int x = begin; x < end; ++x) into[x] += from[x + offset];
}

int within(int at, int length, int radius) {
  return std::min(length - 1, at + radius) - std::max(0, at - radius) + 1;
}

}  // namespace

// Each sum is added up anew, in rising order: a running difference would keep the rounding of what has
// passed. Row by row, so that neighbours in memory are worked on together.
std::vector<double> Windows::sums(const std::vector<double>& values) const {
  const auto w = static_cast<std::size_t>(width);
  std::vector<double> rows(values.size()), result(values.size());
  for (int y = 0; y < height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * w;
    for (int k = -radius; k <= radius; ++k) add_shifted(&values[row], &rows[row], width, k);
  }
  for (int y = 0; y < height; ++y) {
    double* into = &result[static_cast<std::size_t>(y) * w];
    for (int k = std::max(0, y - radius); k <= std::min(height - 1, y + radius); ++k) {
      add_shifted(&rows[static_cast<std::size_t>(k) * w], into, width, 0);
    }
  }
  return result;
}

std::vector<double> Windows::counts() const {
  std::vector<double> result;
  result.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const int rows = within(y, height, radius);
    for (int x = 0; x < width; ++x) result.push_back(rows * within(x, width, radius));
  }
  return result;
}

std::vector<double> Windows::means_of_others(const std::vector<double>& values) const {
  std::vector<double> means = sums(values);
  const std::vector<double> pixels = counts();
  for (std::size_t i = 0; i < means.size(); ++i) {
    means[i] = (means[i] - values[i]) / std::max(1.0, pixels[i] - 1.0);
  }
  return means;
}

}  // namespace raykiln::render
