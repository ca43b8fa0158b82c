#include "raykiln/sampling/discrete_distribution.hpp"

#include <algorithm>
#include <numeric>

namespace raykiln::render {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights)
    : cumulative_(weights.size()) {
  std::partial_sum(weights.begin(), weights.end(), cumulative_.begin());
}

// The first index whose cumulative sum exceeds u * total: strictly, so that a run of zero weights
// is passed over. u * total can round up to the total itself; the last index with any weight, the
// first whose sum is the total, takes that draw.
std::size_t DiscreteDistribution::sample(double u) const {
  auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), u * total());
  if (found == cumulative_.end()) {
    found = std::lower_bound(cumulative_.begin(), cumulative_.end(), total());
  }
  return static_cast<std::size_t>(found - cumulative_.begin());
}

double DiscreteDistribution::probability(std::size_t index) const {
  const double below = index == 0 ? 0.0 : cumulative_[index - 1];
  return (cumulative_[index] - below) / total();
}

}  // namespace raykiln::render
