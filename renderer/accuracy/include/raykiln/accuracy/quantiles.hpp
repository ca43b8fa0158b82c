// Quantiles that intervals are made of.
#pragma once

namespace raykiln::render {

/// Half width of the central 95 % of the standard normal distribution.
inline constexpr double kNormal95 = 1.959963984540054;

/// Half width of the central 95 % of Student's t with so many degrees of freedom; infinite below 1.
[[nodiscard]] double student_t95(double degrees_of_freedom);

}  // namespace raykiln::render
