// Chances of values at least as far out as the one seen.
#pragma once

namespace raykiln::render {

/// P(|N| >= z), N standard normal.
[[nodiscard]] double normal_two_sided(double z);

/// Bound of P(|sum of a_i s_i| >= z) for fixed a_i with sum of squares 1 and independent fair signs s_i:
/// min(1, c P(|N| >= z)), c = 1 / (4 P(N >= sqrt 2)) (Bentkus & Dzindzalieta 2015, theorem 1.1).
[[nodiscard]] double sign_sum_two_sided(double z);

/// z at which sign_sum_two_sided falls to `chance`, 0 < chance < 1.
[[nodiscard]] double sign_sum_quantile(double chance);

/// P(X >= ratio * degrees), X chi-square; by the cube-root transform of Wilson & Hilferty (1931).
[[nodiscard]] double chi_square_above(double ratio, double degrees);

}  // namespace raykiln::render
