// Draws an index with probability proportional to its weight.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace raykiln::render {

/// Cumulative sums in double, searched by bisection. Weights must be finite and >= 0; an index of
/// weight 0 is never drawn. Scaling all weights by a power of two changes no draw.
class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  explicit DiscreteDistribution(std::span<const double> weights);

  /// True when no index can be drawn.
  [[nodiscard]] bool empty() const { return !(total() > 0.0); }
  [[nodiscard]] double total() const { return cumulative_.empty() ? 0.0 : cumulative_.back(); }

  /// The index for u in [0, 1). Precondition: not empty().
  [[nodiscard]] std::size_t sample(double u) const;

  [[nodiscard]] std::span<const double> cumulative() const { return cumulative_; }

  [[nodiscard]] std::size_t bytes() const { return cumulative_.capacity() * sizeof(double); }

  [[nodiscard]] double probability(std::size_t index) const;

 private:
  std::vector<double> cumulative_;
};

}  // namespace raykiln::render
