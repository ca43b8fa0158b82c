// What shines: lights without a surface, triangles whose material emits, the environment.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "raykiln/math/ray.hpp"
#include "raykiln/sampling/discrete_distribution.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/scene/scene.hpp"
#include "raykiln/shading/emitter_choice.hpp"
#include "raykiln/shading/emitter_tree.hpp"
#include "raykiln/shading/made_once.hpp"
#include "raykiln/shading/surface_point.hpp"

namespace raykiln::render {

class EnvironmentLight;  // environment_light.hpp

/// A point on an emitting triangle.
struct EmitterSample {
  SurfacePoint point;
  std::uint32_t triangle = 0;
  double u = 0.0, v = 0.0;  ///< barycentrics in it
  Rgbd radiance{0.0};  ///< the same to both sides, of a white texture, W sr^-1 m^-2
  double pdf_area = 0.0;  ///< m^-2; 0 where nothing can be drawn
};

/// Emitting triangles, drawn with probability proportional to area times the largest channel of
/// their radiance, times the mean of its texture (not luminance: permuting channels must not change a draw), or, from a tree,
/// by what they may bring to a receiver; then uniformly by area; the lights without a surface that shine at all; the environment map, if there is one.
/// Triangles of zero area or radiance are left out. Nothing changes after construction but that the tree is
/// built, once, by whichever thread first asks for it: scenes whose emitters are chosen by power have none.
class Emitters {
 public:
  explicit Emitters(const Scene& scene);

  [[nodiscard]] bool has_triangles() const { return !distribution_.empty(); }
  /// Of the tables, but for the environment's; with the tree, be it built yet or not. 0 where nothing shines.
  [[nodiscard]] std::size_t bytes() const {
    return triangles_.capacity() * sizeof(std::uint32_t) + distribution_.bytes() +
           weights_.capacity() * sizeof(double) + tree_bytes_ + point_lights_.capacity() * sizeof(PointLight) +
           spot_lights_.capacity() * sizeof(SpotLight) +
           directional_lights_.capacity() * sizeof(DirectionalLight);
  }

  /// The emitting triangles, ascending, and what sample() draws one of them by.
  [[nodiscard]] std::span<const std::uint32_t> triangles() const { return triangles_; }
  [[nodiscard]] std::span<const double> cumulative() const { return distribution_.cumulative(); }

  [[nodiscard]] std::span<const PointLight> point_lights() const { return point_lights_; }
  [[nodiscard]] std::span<const SpotLight> spot_lights() const { return spot_lights_; }
  [[nodiscard]] std::span<const DirectionalLight> directional_lights() const {
    return directional_lights_;
  }
  /// Null without a map, and for a black one.
  [[nodiscard]] const EnvironmentLight* environment() const { return environment_.get(); }

  /// Uses dimensions kLightChoice, kLightU and kLightV. Precondition: has_triangles().
  [[nodiscard]] EmitterSample sample(const Scene& scene, const VertexKey& vertex) const;

  /// Density per area with which sample() finds a point of a triangle of this material, m^-2.
  /// Precondition: has_triangles().
  [[nodiscard]] double pdf_area(std::uint32_t material) const {
    return weights_[material] / distribution_.total();
  }

  /// False only if no point that sample() can find lies within a distance of `width` of the unit vector `axis`, as a
  /// unit vector from `from`: by the box of all emitting triangles.
  [[nodiscard]] bool may_lie_along(const Vec3d& from, const Vec3f& axis, double width) const;
  /// That box.
  [[nodiscard]] const Bounds3f& box() const { return box_; }

  /// Is the tree to be used where this is asked for?
  [[nodiscard]] bool by_tree(EmitterChoice choice) const {
    if (choice == EmitterChoice::kAuto) return triangles_.size() >= kTreeFrom;
    return has_triangles() && choice == EmitterChoice::kTree;
  }

  /// The same from the tree, with the same dimensions; pdf_area is 0 where no emitter can light the receiver.
  [[nodiscard]] EmitterSample sample(const Scene& scene, const VertexKey& vertex,
                                     const EmitterReceiver& receiver) const;

  /// Density per area with which that finds a point of this triangle, m^-2; 0 for one that is never drawn.
  [[nodiscard]] double pdf_area(const Scene& scene, std::uint32_t triangle,
                                const EmitterReceiver& receiver) const {
    return tree(scene).pdf_area(receiver, triangle);
  }

  /// The tree itself, made on the first demand. Precondition: has_triangles().
  [[nodiscard]] const EmitterTree& tree(const Scene& scene) const;
  /// Makes it, if no one has. False once stop is requested. Precondition: has_triangles().
  bool make_tree(const Scene& scene, const std::stop_token& stop) const;

 private:
  struct TreeOnDemand {
    MadeOnce made;
    std::optional<EmitterTree> tree;
  };

  [[nodiscard]] EmitterSample point_on(const Scene& scene, std::uint32_t triangle,
                                       const VertexKey& vertex) const;

  std::vector<std::uint32_t> triangles_;  ///< ascending
  Bounds3f box_;                          ///< of them
  std::unique_ptr<TreeOnDemand> tree_;    ///< over triangles_; null without
  std::size_t tree_bytes_ = 0;
  DiscreteDistribution distribution_;
  std::vector<double> weights_;  ///< of the emission, one a material; empty without triangles
  std::vector<PointLight> point_lights_;
  std::vector<SpotLight> spot_lights_;
  std::vector<DirectionalLight> directional_lights_;
  std::shared_ptr<const EnvironmentLight> environment_;
};

/// Weight of a sample of density p when density q could have found it too: p^2 / (p^2 + q^2), the
/// power heuristic with exponent 2 (Veach & Guibas 1995). p > 0, q >= 0, both may be huge.
[[nodiscard]] inline double power_heuristic(double p, double q) {
  const double ratio = q / p;
  return 1.0 / (1.0 + ratio * ratio);
}

}  // namespace raykiln::render
