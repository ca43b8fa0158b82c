// Sine and cosine of a share of a full turn as short series, the same for one number and for several at once. Constants
// alone, so that units with instruction sets of their own may read them.
//
// v - q/4 with q the integer nearest to 4 v is exact and at most 1/8, so x = 2 pi (v - q/4) is within pi/4;
// there sin x = x + x (x^2 S(x^2)), cos x = 1 + x^2 C(x^2) by Taylor, cut where the next terms are
// below 1e-16 and 1e-18, and q turns the pair.
#pragma once

namespace raykiln::render::turn_series {

/// Adding and taking it away rounds a number below 2^51 to an integer.
inline constexpr double kToInteger = 0x1.8p52;

inline constexpr int kTerms = 8;
/// (-1)^k / (2k + 1)! for k = 8 .. 1.
inline constexpr double kSine[kTerms] = {
    1.0 / 355687428096000.0, -1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0,
    1.0 / 362880.0,          -1.0 / 5040.0,          1.0 / 120.0,        -1.0 / 6.0};
/// (-1)^k / (2k)! for k = 8 .. 1.
inline constexpr double kCosine[kTerms] = {
    1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
    1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0,        -1.0 / 2.0};

}  // namespace raykiln::render::turn_series
