// The variance of a mean whose samples depend on each other, from replicates that do not.
#pragma once

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Of the mean luminance of all samples. Replicates are independent of each other; how the samples of one
/// depend on each other does not matter, nor how many of them each has.
struct ReplicateVariance {
  double variance = 0.0;
  double degrees = 0.0;  ///< of freedom, about: 3 for 4 replicates of equal size; 0: nothing is known
};

/// With the shares w of the samples, m the replicates' means and M their weighted mean: the sum of
/// a_r (m_r - M)^2 with a_r = w_r^2 (1 - A) / (1 - 2 w_r), A = B / (1 + B), B = sum of w_r^2 / (1 - 2 w_r), has the
/// expectation of sum w_r^2 Var(m_r) whatever these variances are: E (m_r - M)^2 = (1 - 2 w_r) Var(m_r) + sum w_s^2
/// Var(m_s), and sum a = A. With equal shares it is the sum of squares over R (R - 1). There is none where a
/// replicate has half of the samples: below 33 of them.
[[nodiscard]] ReplicateVariance replicate_variance(const PixelSums& sums);

}  // namespace raykiln::render
