#include <array>
#include <cmath>

#include "raykiln/integrator/camera_ray.hpp"
#include "raykiln/sampling/warp.hpp"

namespace raykiln::render {
namespace {

constexpr double kWidth = 3.0;  ///< pixels
// The four terms of Harris 1978, "On the use of windows for harmonic analysis": 92 dB.
constexpr std::array<double, 4> kTerms{0.35875, 0.48829, 0.14128, 0.01168};

struct Window {
  double share;    ///< of the window below t
  double density;  ///< at t, over [0, 1]
};

Window window(double t) {
  Window w{t, 1.0};
  for (int k = 1; k < 4; ++k) {
    const double sign = k % 2 == 1 ? -1.0 : 1.0, turn = 2.0 * kPi * k;
    const double term = sign * kTerms[static_cast<std::size_t>(k)] / kTerms[0];
    w.share += term * std::sin(turn * t) / turn;
    w.density += term * std::cos(turn * t);
  }
  return w;
}

/// Where the window's share reaches u: steps of Newton's, halvings where one would leave what is known.
double inverse(double u) {
  double low = 0.0, high = 1.0, t = 0.5;
  for (int i = 0; i < 60 && high - low > 0x1p-40; ++i) {
    const Window w = window(t);
    (w.share < u ? low : high) = t;
    const double next = t - (w.share - u) / w.density;
    if (next > low && next < high) {
      if (std::abs(next - t) < 0x1p-40) return next;
      t = next;
    } else {
      t = 0.5 * (low + high);
    }
  }
  return t;
}

}  // namespace

double filtered_offset(PixelFilter filter, double u) {
  if (filter == PixelFilter::kBox) return u;
  return 0.5 + kWidth * (inverse(u) - 0.5);
}

}  // namespace raykiln::render
