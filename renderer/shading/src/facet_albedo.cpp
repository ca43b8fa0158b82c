#include "raykiln/shading/facet_albedo.hpp"

#include <algorithm>
#include <cmath>

#include "even_entries.hpp"
#include "raykiln/sampling/warp.hpp"
#include "raykiln/shading/ggx.hpp"

namespace raykiln::render {
namespace {

constexpr double kLimitAlpha = 1e-4;       ///< stands for 0, to which all tends by cosine / span
constexpr double kMeansAnOctave = 6.0;     ///< entries of means_ for a factor of 2 of alpha

/// Calls `meets` with facets' normals that are visible from wo and their weights, which sum to 1. Half of the
/// turn: the other half mirrors it. Steep facets are rare and lose most: they are gone through finely.
template <class Meets>
void for_facets(const Vec3d& wo, double alpha, int turns, int tilts, Meets&& meets) {
  for (int j = 0; j < tilts; ++j) {
    const auto edge = [&](int k) { return std::pow(static_cast<double>(k) / tilts, 4.0); };
    const double v = 1.0 - std::pow((j + 0.5) / tilts, 4.0), weight = (edge(j + 1) - edge(j)) / turns;
    for (int i = 0; i < turns; ++i) {
      meets(ggx_visible_normal(wo, alpha, 0.5 * (i + 0.5) / turns, v), weight);
    }
  }
}

Vec3d seen_under(double cosine) { return {std::sqrt((1.0 - cosine) * (1.0 + cosine)), 0.0, cosine}; }

FacetAlbedo integrate(double cosine, double alpha) {
  const Vec3d wo = seen_under(cosine);
  const double span = ggx_span(cosine, alpha);
  FacetAlbedo sum;
  for_facets(wo, alpha, 16, 48, [&](const Vec3d& h, double weight) {
    const double c = std::min(dot(wo, h), 1.0), rest = 1.0 - c;
    const double to = 2.0 * c * h.z - cosine;
    const double stopped = to > 0.0 ? ggx_stopped(cosine, span, to, ggx_span(to, alpha), alpha) : 1.0;
    sum.lost += weight * stopped;
    sum.grazing += weight * (1.0 - stopped) * rest * rest * rest * rest * rest;
  });
  return sum;
}

/// Cosine of which `x` is the cosine over the span.
double cosine_at(double x, double alpha) {
  const double rest = (1.0 - x) * (1.0 + x) + x * x * alpha * alpha;
  return rest > 0.0 ? std::min(x * alpha / std::sqrt(rest), 1.0) : 1.0;
}

/// What `lost` goes with where alpha is small: alpha^2 seen from above, 1 - x near grazing.
double lost_scale(double x, double alpha) { return 1.0 - x + alpha * alpha; }

double mean_scale(double alpha) { return alpha * alpha * (1.0 - std::log(alpha)); }

/// Of cosines, closer near grazing: their places in a table are square roots.
double square_node(std::size_t i, std::size_t count) { return entry_place(i, count) * entry_place(i, count); }

}  // namespace

const FacetAlbedoTables& FacetAlbedoTables::get() {
  static const FacetAlbedoTables tables;
  return tables;
}

FacetAlbedoTables::FacetAlbedoTables() {
  for (std::size_t r = 0; r < kRoughnesses; ++r) {
    const double roughness = entry_place(r, kRoughnesses);
    const double alpha = std::max(roughness * roughness, kLimitAlpha);
    for (std::size_t i = 0; i < kCosines; ++i) {
      const double x = square_node(i, kCosines);
      lost_[r][i] = integrate(cosine_at(x, alpha), alpha).lost / lost_scale(x, alpha);
      const FacetAlbedo seen = integrate(x, alpha);
      grazing_[r][i] = seen.grazing / (1.0 - seen.lost);
    }
  }
  constexpr int kSteps = 128;
  for (std::size_t i = 0; i < kMeans; ++i) {
    const double alpha = std::exp2(-static_cast<double>(i) / kMeansAnOctave);
    const LostDirections directions(alpha);
    FacetAlbedo mean;
    for (int k = 0; k < kSteps; ++k) {
      const double cosine = directions.sample_cosine((k + 0.5) / kSteps);
      mean.lost += lost(cosine, alpha) * cosine / (kPi * directions.pdf(cosine)) / kSteps;
      mean.grazing += at(std::sqrt((k + 0.5) / kSteps), alpha).grazing / kSteps;
    }
    means_[i] = {mean.lost / mean_scale(alpha), mean.grazing};
  }
}

double FacetAlbedoTables::interpolate(const Table& table, double x, double roughness) {
  const BetweenEntries row(roughness, kRoughnesses), column(std::sqrt(x), kCosines);
  const auto along = [&](std::size_t r) {
    return column.of(table[r][column.low], table[r][column.low + 1]);
  };
  return row.of(along(row.low), along(row.low + 1));
}

double FacetAlbedoTables::lost(double cosine, double alpha) const {
  const double x = cosine / ggx_span(cosine, alpha);
  // 1 - x without cancellation.
  const double span = ggx_span(cosine, alpha);
  const double less = alpha * alpha * std::max((1.0 - cosine) * (1.0 + cosine), 0.0) / (span * (span + cosine));
  return std::min(interpolate(lost_, x, std::sqrt(alpha)) * (less + alpha * alpha), 1.0);
}

double FacetAlbedoTables::grazing_share(double cosine, double alpha) const {
  return interpolate(grazing_, cosine, std::sqrt(alpha));
}

FacetAlbedo FacetAlbedoTables::at(double cosine, double alpha) const {
  const double gone = lost(cosine, alpha);
  return {gone, (1.0 - gone) * grazing_share(cosine, alpha)};
}

FacetAlbedo FacetAlbedoTables::mean(double alpha) const {
  const BetweenEntries place(-std::log2(alpha) * kMeansAnOctave / static_cast<double>(kMeans - 1), kMeans);
  const FacetAlbedo& a = means_[place.low];
  const FacetAlbedo& b = means_[place.low + 1];
  return {place.of(a.lost, b.lost) * mean_scale(alpha), place.of(a.grazing, b.grazing)};
}

LostDirections::LostDirections(double alpha) : b(0.5 * alpha * alpha), scale(std::log1p(1.0 / b)) {}

double LostDirections::sample_cosine(double u) const {
  return std::sqrt(std::min(b * std::expm1(u * scale), 1.0));
}

double LostDirections::pdf(double cosine) const {
  return cosine / (kPi * (cosine * cosine + b) * scale);
}

}  // namespace raykiln::render
