// Light from an environment map: looked up by direction, and sampled where it is bright.
#pragma once

#include <memory>
#include <vector>

#include "raykiln/sampling/random.hpp"
#include "raykiln/scene/environment_map.hpp"

namespace raykiln::render {

struct EnvironmentSample {
  Vec3d wi{0.0};       ///< unit, towards the light
  Rgbd radiance{0.0};  ///< W sr^-1 m^-2
  double pdf = 0.0;    ///< sr^-1
};

/// A texel is drawn with probability proportional to its solid angle times the largest channel of
/// its radiance (not luminance: permuting channels must not change a draw), then a direction
/// uniformly within its solid angle. So the density is largest channel / total, exactly, at the poles
/// too. A table of 8 bytes a texel.
class EnvironmentLight {
 public:
  explicit EnvironmentLight(std::shared_ptr<const EnvironmentMap> map);

  /// False for a black map, which can be looked at and not sampled.
  [[nodiscard]] bool shines() const { return total() > 0.0; }
  /// Integral of the largest channel over the sphere, W m^-2.
  [[nodiscard]] double total() const { return rows_.empty() ? 0.0 : rows_.back(); }

  /// u and v in [0, 1). Precondition: shines().
  [[nodiscard]] EnvironmentSample sample(double u, double v) const;
  /// With dimensions kEnvironmentU and kEnvironmentV.
  [[nodiscard]] EnvironmentSample sample(const VertexKey& vertex) const;

  struct Seen {
    Rgbd radiance{0.0};
    double pdf = 0.0;  ///< with which sample() finds this direction, sr^-1
  };
  /// `direction` of any length > 0.
  [[nodiscard]] Seen towards(const Vec3d& direction) const;

 private:
  [[nodiscard]] Seen texel(std::size_t row, std::size_t column) const;

  std::shared_ptr<const EnvironmentMap> map_;
  std::vector<double> rows_;     ///< sums of the weights of all rows up to this one
  std::vector<double> columns_;  ///< for each row: sums of its texels up to this one
  double cos_rotation_ = 1.0, sin_rotation_ = 0.0;
};

}  // namespace raykiln::render
