// Error of pictures without a reference: how they scatter between seeds.
#pragma once

#include <cmath>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render::bench {

inline std::vector<double> means_of(const Film& film) {
  std::vector<double> means = film.plane("beauty");
  const auto counts = film.plane("samples");
  for (std::size_t i = 0; i < means.size(); ++i) means[i] /= counts[i / 3];
  return means;
}

/// Pictures of all seeds after n samples.
struct Scatter {
  explicit Scatter(std::size_t values) : sum(values), squares(values) {}
  std::vector<double> sum, squares;
  std::vector<double> whole;  ///< mean of each picture
  void add(const std::vector<double>& picture) {
    double mean = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += picture[i];
      squares[i] += picture[i] * picture[i];
      mean += picture[i] / static_cast<double>(sum.size());
    }
    whole.push_back(mean);
  }
  [[nodiscard]] double mean() const {
    double total = 0.0;
    for (const double m : whole) total += m / static_cast<double>(whole.size());
    return total;
  }
  /// Of mean().
  [[nodiscard]] double variance() const {
    const auto n = static_cast<double>(whole.size());
    double total = 0.0;
    for (const double m : whole) total += (m - mean()) * (m - mean()) / (n * (n - 1.0));
    return total;
  }
  [[nodiscard]] double rel_mse() const {
    const auto n = static_cast<double>(whole.size());
    const double floor = 0.01 * mean() * mean();
    double total = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double m = sum[i] / n, scatter = std::fmax(0.0, squares[i] - n * m * m) / (n - 1.0);
      total += scatter / (m * m + floor);
    }
    return total / static_cast<double>(sum.size());
  }
};

}  // namespace raykiln::render::bench
