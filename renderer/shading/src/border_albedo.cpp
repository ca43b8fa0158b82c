// What one meeting with a rough border leaves of light. It bends where facets start to reflect totally, over a range of
// cosines of about alpha; a table that is blind to that gave 1.2 % too much at roughness 0.4.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "even_entries.hpp"
#include "raykiln/shading/facet_albedo.hpp"
#include "raykiln/shading/fresnel.hpp"
#include "raykiln/shading/ggx.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kCosines = 40, kRoughnesses = 25, kIndices = 61;
constexpr double kLimitAlpha = 1e-4;  ///< stands for 0, to which all tends by cosine / span

/// Where a cosine stands in a row of the table, in [0, 1]: rising with it, fast near grazing over the width of the
/// masking, and about the critical angle over the width of the facets. The same place is the same
/// distance from both, in widths, for other roughnesses and indices, between which rows are interpolated.
class Places {
 public:
  Places(double alpha, double eta)
      : alpha_(alpha),
        critical_(eta < 1.0 ? std::sqrt((1.0 - eta) * (1.0 + eta)) : 0.0),
        width_(0.5 * alpha),
        from_(bend(-critical_)),
        span_(bend(1.0 - critical_) - from_) {}

  [[nodiscard]] double of(double cosine) const {
    const double x = cosine / ggx_span(cosine, alpha_);
    return 0.3 * std::sqrt(x) + 0.5 * cosine + 0.2 * (bend(cosine - critical_) - from_) / span_;
  }

  /// By bisection, which ends at neighbouring doubles or at a cosine next to which nothing is to be told apart.
  [[nodiscard]] double cosine_at(double place) const {
    double low = 1e-12, high = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (of(middle) < place ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

 private:
  [[nodiscard]] double bend(double d) const { return d / (std::abs(d) + width_); }

  double alpha_, critical_, width_, from_, span_;
};

/// Over visible facets, by a Fibonacci lattice over half of the turn (the other half mirrors it) and the height: a product
/// of midpoints shows the edge of total reflection with 10 times the error. Steep facets are rare and
/// lose most: they are gone through more finely.
double integrate(double cosine, double alpha, double eta) {
  constexpr int kPoints = 987, kStep = 610;
  const Vec3d wo{std::sqrt((1.0 - cosine) * (1.0 + cosine)), 0.0, cosine};
  const double span = ggx_span(cosine, alpha);
  const auto passed = [&](double to) {
    return to > 0.0 ? ggx_passes(cosine, span, to, ggx_span(to, alpha)) : 0.0;
  };
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double t = (i + 0.5) / kPoints, turn = (i * kStep % kPoints + 0.5) / kPoints;
    const Vec3d h = ggx_visible_normal(wo, alpha, 0.5 * turn, 1.0 - t * t);
    const double c = std::min(dot(wo, h), 1.0);
    const FresnelTerm border = fresnel_exact(c, 1.0, eta);
    double leaves = border.reflectance * passed(2.0 * c * h.z - cosine);
    if (!border.total_reflection) {
      leaves += (1.0 - border.reflectance) * passed(-refract(wo, h, c, border.cos_t, 1.0, eta).z);
    }
    sum += 2.0 * t * leaves;
  }
  return sum / kPoints;
}

/// By index, from 1/3 to 3, closer to 1 where the critical angle moves fastest; roughness; and place. A row is computed when
/// it is first asked for, by whichever thread: a material of one roughness needs 8 of 1525.
class BorderTable {
 public:
  [[nodiscard]] double passed(double cosine, double alpha, double eta) {
    const double ratio = (eta - 1.0) / (eta + 1.0);
    const BetweenEntries column(Places(alpha, eta).of(cosine), kCosines), roughness(std::sqrt(alpha), kRoughnesses);
    const BetweenEntries index(0.5 + std::copysign(std::sqrt(0.5 * std::abs(ratio)), ratio), kIndices);
    const auto along = [&](std::size_t k, std::size_t r) {
      const auto& kept = row(k, r);
      return column.of(kept[column.low], kept[column.low + 1]);
    };
    const auto plane = [&](std::size_t k) {
      return roughness.of(along(k, roughness.low), along(k, roughness.low + 1));
    };
    return index.of(plane(index.low), plane(index.low + 1));
  }

 private:
  struct Row {
    std::once_flag computed;
    std::array<double, kCosines> kept{};
  };

  const std::array<double, kCosines>& row(std::size_t k, std::size_t r) {
    Row& row = rows_[k * kRoughnesses + r];
    std::call_once(row.computed, [&] { compute(row, entry_place(k, kIndices) - 0.5, entry_place(r, kRoughnesses)); });
    return row.kept;
  }

  static void compute(Row& row, double place, double roughness) {
    const double ratio = 2.0 * place * std::abs(place), eta = (1.0 + ratio) / (1.0 - ratio);
    const double alpha = std::max(roughness * roughness, kLimitAlpha);
    const Places places(alpha, eta);
    for (std::size_t i = 0; i < kCosines; ++i) {
      row.kept[i] = integrate(places.cosine_at(entry_place(i, kCosines)), alpha, eta);
    }
  }

  std::array<Row, kIndices * kRoughnesses> rows_{};
};

}  // namespace

// Away from grazing a polished border loses about alpha^2/cosine^2: less than 1e-8, and no table is needed.
double border_albedo(double cosine, double alpha, double eta) {
  static BorderTable table;
  return alpha < 1e-4 * cosine ? 1.0 : table.passed(cosine, alpha, eta);
}

}  // namespace raykiln::render
