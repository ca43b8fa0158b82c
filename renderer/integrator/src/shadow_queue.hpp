// Shadow rays that wait to be traced together, each with the light it brings if nothing is hit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gap_walk.hpp"
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

  [[nodiscard]] bool full() const { return size_ >= kCapacity; }

  /// A way from `from`, which is clear of its surface, to `to`; with kInfinity along `to`.
  struct Way {
    Vec3f from, to;
    ShadowEnd end;
    std::uint32_t from_triangle = kNoHit, to_triangle = kNoHit;  ///< on which it begins and ends
  };
  void push(const Way& way, const Rgbd& light, std::uint32_t slot);

  struct Waiting {
    Rgbd light;
    std::uint32_t slot;
  };
  /// Room for rays that are written in place, behind those that wait.
  struct Room {
    std::size_t first;
    Ray* rays;
    Waiting* waiting;
    std::uint32_t* from;  ///< triangles on which they begin and end, kNoHit unless written
    std::uint32_t* to;
  };
  [[nodiscard]] Room open(std::size_t most);
  /// Keeps the first `count` of them.
  void close(const Room& room, std::size_t count);

  /// Traces the queue and adds the light of unblocked rays to PathResult::direct, in the order in
  /// which they came. Every triangle blocks, glass too, but where there are gaps.
  void flush(const KdTree& tree, Traversal traversal, std::span<PathResult> results,
             RenderStats& stats, const Gaps& gaps = {});

  void clear();

 private:
  void make_room(std::size_t size);
  [[nodiscard]] std::span<const Ray> rays() const { return {rays_.data(), size_}; }
  [[nodiscard]] EndTriangles ends() const { return {{from_.data(), size_}, {to_.data(), size_}}; }
  void flush_through_gaps(const KdTree& tree, Traversal traversal, const Gaps& gaps,
                          std::span<PathResult> results, RenderStats& stats);

  /// Longer than size_ once they have been: room is made, and its elements constructed, once.
  std::vector<Ray> rays_;
  std::vector<Waiting> waiting_;
  std::vector<std::uint32_t> from_, to_;
  std::size_t size_ = 0;
  std::vector<Occlusion> blocked_;
  std::vector<Hit> hits_;      ///< where surfaces may have gaps
  std::vector<double> share_;  ///< of the light that gets through them
  GapWalk gap_walk_;
};

}  // namespace raykiln::render
