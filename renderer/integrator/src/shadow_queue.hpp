// Shadow rays that wait to be traced together, each with the light it brings if nothing is hit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/integrator/path_tracer.hpp"

namespace raykiln::render {

/// What a shadow ray runs to.
enum class ShadowEnd : std::uint8_t {
  kSurface,     ///< the ray_end() of a point on a surface
  kPointLight,  ///< the place of a light itself
  kInfinity,    ///< a direction instead of a place: nothing may be in the way at all
};

class ShadowQueue {
 public:
  /// So many rays make a good call and bound the memory, however many lights a scene has.
  static constexpr std::size_t kCapacity = 8192;

  [[nodiscard]] bool full() const { return rays_.size() >= kCapacity; }

  /// A ray from `from`, which is clear of its surface, to `to`; with kInfinity along `to`.
  void push(const Vec3f& from, const Vec3f& to, ShadowEnd end, const Rgbd& light,
            std::uint32_t slot);

  /// Traces the queue and adds the light of unblocked rays to PathResult::direct, in the order in
  /// which they came. Every triangle blocks, glass too.
  void flush(const KdTree& tree, Traversal traversal, std::span<PathResult> results,
             RenderStats& stats);

  void clear();

 private:
  struct Waiting {
    Rgbd light;
    std::uint32_t slot;
  };
  std::vector<Ray> rays_;
  std::vector<Waiting> waiting_;
  std::vector<Occlusion> blocked_;
};

}  // namespace raykiln::render
