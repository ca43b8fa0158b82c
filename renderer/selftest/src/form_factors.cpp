#include "raykiln/selftest/form_factors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPoints = 16;

double corner_factor(double a, double b) {
  const double ra = std::sqrt(1.0 + a * a), rb = std::sqrt(1.0 + b * b);
  return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2.0 * kPi);
}

struct Quadrature {
  std::array<double, kPoints> x{}, w{};  ///< on [-1/2, 1/2]
};

/// Nodes are the zeros of the Legendre polynomial, found by Newton's method.
Quadrature gauss_legendre() {
  Quadrature q;
  for (int i = 0; i < kPoints; ++i) {
    double z = std::cos(kPi * (i + 0.75) / (kPoints + 0.5)), slope = 0.0;
    for (int step = 0; step < 60; ++step) {
      double p = 1.0, before = 0.0;
      for (int n = 1; n <= kPoints; ++n) {
        const double next = ((2.0 * n - 1.0) * z * p - (n - 1.0) * before) / n;
        before = p;
        p = next;
      }
      slope = kPoints * (z * p - before) / (z * z - 1.0);
      z -= p / slope;
    }
    const auto k = static_cast<std::size_t>(i);
    q.x[k] = 0.5 * z;
    q.w[k] = 1.0 / ((1.0 - z * z) * slope * slope);
  }
  return q;
}

/// Kernel cos cos/(pi r^2) between points of the two plates.
double kernel(double dx, double dy, double h) {
  const double r2 = dx * dx + dy * dy + h * h;
  return h * h / (kPi * r2 * r2);
}

struct Plates {
  Quadrature q = gauss_legendre();
  std::vector<double> l1, l2;
  double h = 1.0;

  [[nodiscard]] double gathered(const std::vector<double>& from, double x, double y) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      for (std::size_t j = 0; j < kPoints; ++j) {
        sum += q.w[i] * q.w[j] * from[i * kPoints + j] * kernel(x - q.x[i], y - q.x[j], h);
      }
    }
    return sum;
  }
  [[nodiscard]] double mean(const std::vector<double>& l) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kPoints; ++i) {
      for (std::size_t j = 0; j < kPoints; ++j) sum += q.w[i] * q.w[j] * l[i * kPoints + j];
    }
    return sum;
  }
};

}  // namespace

double element_to_rectangle(double x0, double x1, double y0, double y1, double h) {
  return corner_factor(x1 / h, y1 / h) - corner_factor(x0 / h, y1 / h) -
         corner_factor(x1 / h, y0 / h) + corner_factor(x0 / h, y0 / h);
}

double perpendicular_rectangles(double w, double h, double l) {
  const double W = w / l, H = h / l, w2 = W * W, h2 = H * H, r = std::sqrt(w2 + h2);
  const double logs = std::log((1.0 + w2) * (1.0 + h2) / (1.0 + w2 + h2)) +
                      w2 * std::log(w2 * (1.0 + w2 + h2) / ((1.0 + w2) * (w2 + h2))) +
                      h2 * std::log(h2 * (1.0 + h2 + w2) / ((1.0 + h2) * (h2 + w2)));
  return (W * std::atan(1.0 / W) + H * std::atan(1.0 / H) - r * std::atan(1.0 / r) + 0.25 * logs) /
         (kPi * W);
}

Outcome square_over_element(const SquareOverElement& in, bool emitter_sampling,
                            std::uint64_t samples) {
  const double half = 0.5 * in.side, reach = in.height + std::hypot(in.x, in.y) + in.side;
  SmallScene s;
  s.level_square(static_cast<float>(3.0 * reach), 0.0F,
                 s.material(matte(static_cast<float>(in.albedo))));
  s.level_square(static_cast<float>(half), static_cast<float>(in.height),
                 s.material(matte(0.0F, static_cast<float>(in.radiance))), false);
  const Vec3d point(in.x, in.y, 0.0);
  s.look(point + in.height * Vec3d(0.004, 0.003, 0.5), point, {0, 1, 0}, 1e-6);
  RenderSettings settings;
  settings.width = settings.height = 4;
  settings.max_depth = 1;
  settings.light_model = in.model;
  settings.emitter_sampling = emitter_sampling;
  const double factor = element_to_rectangle(-half - in.x, half - in.x, -half - in.y, half - in.y,
                                             in.height);
  return statistically(measure(s.scene(), settings, samples), in.albedo * in.radiance * factor, 1e-5);
}

// Neumann series: the two plates return at most albedo_1 albedo_2 each time round.
PlateRadiances parallel_squares_truth(const ParallelSquares& in) {
  constexpr std::size_t kCells = static_cast<std::size_t>(kPoints) * kPoints;
  Plates p;
  p.h = in.distance;
  p.l1.assign(kCells, in.emission);
  p.l2.assign(kCells, 0.0);
  for (int round = 0; round < 60; ++round) {
    for (std::size_t k = 0; k < kCells; ++k) {
      p.l2[k] = in.albedo_2 * p.gathered(p.l1, p.q.x[k / kPoints], p.q.x[k % kPoints]);
    }
    for (std::size_t k = 0; k < kCells; ++k) {
      p.l1[k] = in.emission + in.albedo_1 * p.gathered(p.l2, p.q.x[k / kPoints], p.q.x[k % kPoints]);
    }
  }
  return {p.mean(p.l1), p.mean(p.l2), in.emission + in.albedo_1 * p.gathered(p.l2, 0.0, 0.0),
          in.albedo_2 * p.gathered(p.l1, 0.0, 0.0)};
}

Outcome parallel_squares(const ParallelSquares& in, int plate, std::uint64_t samples) {
  SmallScene s;
  const double h = in.distance;
  s.level_square(0.5F, 0.0F,
                 s.material(matte(static_cast<float>(in.albedo_1), static_cast<float>(in.emission))));
  s.level_square(0.5F, static_cast<float>(h), s.material(matte(static_cast<float>(in.albedo_2))), false);
  // The picture is exactly the plate: a pinhole maps a plane across its axis without distortion.
  s.look({0, 0, 0.5 * h}, {0, 0, plate == 1 ? 0.0 : h}, {0, 1, 0}, 2.0 * std::atan(1.0 / h));
  RenderSettings settings;
  settings.width = settings.height = 8;
  settings.max_depth = 64;
  settings.light_model = in.model;
  const PlateRadiances truth = parallel_squares_truth(in);
  return statistically(measure(s.scene(), settings, samples),
                       plate == 1 ? truth.mean_1 : truth.mean_2, 2e-6);
}

Measured touching_rectangles_picture(const TouchingRectangles& in, bool emitter_sampling,
                                     std::uint64_t samples, std::uint64_t seed) {
  const auto w = static_cast<float>(in.receiver), h = static_cast<float>(in.emitter),
             l = static_cast<float>(in.edge);
  SmallScene s;
  s.quad({Vec3f(0, 0, 0), {w, 0, 0}, {w, l, 0}, {0, l, 0}}, s.material(matte(1.0F)));
  s.quad({Vec3f(0, 0, 0), {0, l, 0}, {0, l, h}, {0, 0, h}}, s.material(matte(0.0F, 1.0F)));
  // A picture of one row or column of pixels of the receiver's own shape would not be square:
  // the camera sees more, and black surroundings are left out of the mean by their area.
  const double side = std::max(in.receiver, in.edge), eye = 2.0 * side;
  s.look({0.5 * side, 0.5 * side, eye}, {0.5 * side, 0.5 * side, 0}, {0, 1, 0},
         2.0 * std::atan(0.5 * side / eye));
  RenderSettings settings;
  settings.width = settings.height = 16;
  settings.max_depth = 1;
  settings.light_model = in.model;
  settings.emitter_sampling = emitter_sampling;
  settings.seed = seed;
  Measured m = measure(s.scene(), settings, samples);
  const double share = in.receiver * in.edge / (side * side);
  m.mean /= share;
  m.standard_error /= share;
  return m;
}

Outcome touching_rectangles(const TouchingRectangles& in, bool emitter_sampling,
                            std::uint64_t samples) {
  return statistically(touching_rectangles_picture(in, emitter_sampling, samples),
                       perpendicular_rectangles(in.receiver, in.emitter, in.edge), 2e-6);
}

}  // namespace raykiln::render::selftest
