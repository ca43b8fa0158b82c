// How much light a rough surface of GGX facets sends back after one reflection, if the facets reflect all of
// it: tables that are computed once, when a scene with such a surface first needs them.
#pragma once

#include <array>
#include <cstddef>

namespace raykiln::render {

/// Of light from one direction.
struct FacetAlbedo {
  double lost = 0.0;     ///< share that does not leave after one reflection: 1 - E
  double grazing = 0.0;  ///< mean of (1 - cos)^5 over what leaves, times E: Schlick's term
};

class FacetAlbedoTables {
 public:
  static const FacetAlbedoTables& get();

  /// Seen under `cosine` in [0, 1]; alpha in [kLeastAlpha, 1].
  [[nodiscard]] FacetAlbedo at(double cosine, double alpha) const;
  /// The same, weighted by the cosine over all directions: 2 times the integral over cosine d cosine.
  /// Of what at() returns, so that lobes that are divided by it keep their energy at any alpha.
  [[nodiscard]] FacetAlbedo mean(double alpha) const;

 private:
  FacetAlbedoTables();
  [[nodiscard]] double lost(double cosine, double alpha) const;
  [[nodiscard]] double grazing_share(double cosine, double alpha) const;

  static constexpr std::size_t kCosines = 32, kRoughnesses = 24, kMeans = 162;
  using Table = std::array<std::array<double, kCosines>, kRoughnesses>;
  [[nodiscard]] static double interpolate(const Table& table, double x, double roughness);

  Table lost_{};     ///< over what it goes with at small alpha; by cosine / span and roughness
  Table grazing_{};  ///< as a share of what leaves; by cosine and roughness
  std::array<FacetAlbedo, kMeans> means_{};  ///< by log2(alpha); lost over alpha^2 (1 - ln alpha)
};

/// Directions in which light leaves after several reflections are drawn by cosine^2 = y with density
/// 1/((y + b) ln(1 + 1/b)): what is lost falls like 1/y beyond cosines of about alpha.
struct LostDirections {
  double b = 1.0, scale = 1.0;  ///< scale: ln(1 + 1/b)

  explicit LostDirections(double alpha);
  [[nodiscard]] double sample_cosine(double u) const;
  [[nodiscard]] double pdf(double cosine) const;  ///< sr^-1
};

/// Share of light from one direction that a rough border between two media reflects or lets through
/// after one meeting: of GGX facets with Fresnel's equations. `eta` is the index beyond over the one on
/// this side. Read from a
/// table, of which each row is computed when it is first needed; at most 1 % off, 0.1 % on average, for indices up to 3.
[[nodiscard]] double border_albedo(double cosine, double alpha, double eta);

}  // namespace raykiln::render
