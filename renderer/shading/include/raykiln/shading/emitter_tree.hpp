// The light tree over a scene's emitting triangles, with what a hit on one of them asks for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "raykiln/scene/scene.hpp"
#include "raykiln/shading/light_tree.hpp"

namespace raykiln::render {

/// Immutable. No search and no geometry when asked: a bit a triangle of the mesh, and the area of each emitter.
class EmitterTree {
 public:
  /// `triangles`: ascending, of area above 0; `weights`: of the emission of each material, W sr^-1 m^-2.
  EmitterTree(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, std::span<const double> weights,
              std::span<const Material> materials, const std::stop_token& stop = {});

  /// False: stop was requested before, and there is nothing to sample.
  [[nodiscard]] bool whole() const { return tree_.size() == emitters_.size(); }

  struct Draw {
    std::uint32_t triangle = 0;  ///< of the mesh
    double pdf_area = 0.0;       ///< m^-2
  };
  /// As LightTree::sample.
  [[nodiscard]] std::optional<Draw> sample(const EmitterReceiver& receiver, double u) const;

  /// Density per area with which that finds a point of this triangle, m^-2: the same number, bit for
  /// bit; 0 for one that is not among the emitters.
  [[nodiscard]] double pdf_area(const EmitterReceiver& receiver, std::uint32_t triangle) const;

  /// Of a tree over so many emitters in a mesh of so many triangles.
  [[nodiscard]] static std::size_t bytes(std::size_t emitters, std::size_t triangles);

 private:
  struct Emitter {
    double area;  ///< m^2
    std::uint32_t triangle;
  };
  LightTree tree_;
  std::vector<Emitter> emitters_;
  std::vector<std::uint64_t> shines_;  ///< a bit a triangle
  std::vector<std::uint32_t> before_;  ///< a word of shines_: emitters before it
};

}  // namespace raykiln::render
