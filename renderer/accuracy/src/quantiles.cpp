#include "raykiln/accuracy/quantiles.hpp"

#include <limits>

namespace raykiln::render {

// 1 and 2 have closed forms. Above: Cornish and Fisher's expansion about the normal quantile
// (Abramowitz & Stegun 1964, 26.7.5), good to 4e-3 at 3 degrees and to 1e-4 from 7 on.
double student_t95(double degrees) {
  if (!(degrees >= 1.0)) return std::numeric_limits<double>::infinity();
  if (degrees < 2.0) return 12.706204736174698;
  if (degrees < 3.0) return 4.302652729749464;
  const double z = kNormal95, z2 = z * z, z3 = z2 * z, z5 = z3 * z2, z7 = z5 * z2, z9 = z7 * z2;
  const double k = degrees;
  const double g1 = (z3 + z) / 4.0;
  const double g2 = (5.0 * z5 + 16.0 * z3 + 3.0 * z) / 96.0;
  const double g3 = (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / 384.0;
  const double g4 = (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) / 92160.0;
  return z + g1 / k + g2 / (k * k) + g3 / (k * k * k) + g4 / (k * k * k * k);
}

}  // namespace raykiln::render
