// Paths that are under way: rays apart from the rest, as the tree wants them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "raykiln/accel/kdtree.hpp"
#include "raykiln/math/ray.hpp"
#include "raykiln/integrator/camera_ray.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/shading/light_tree.hpp"

namespace raykiln::render {

/// What a path carries besides its ray.
struct PathState {
  PathKey key;
  Rgbd throughput{1.0};
  /// What of the throughput is no loss: changes of medium, what directions towards casters change of a density, and one
  /// over the rays shot with it.
  double scale = 1.0;
  double pdf = 0.0;          ///< of the ray's direction times the rays shot with it, sr^-1
  std::uint64_t node = 0;    ///< number of the branch among those of its bounce
  std::uint32_t slot = 0;    ///< index of its PathResult
  std::uint16_t bounce = 0;  ///< reflections so far
  bool met_diffuse = false;  ///< one of them was diffuse; kept where caustics are left out alone
};

class PathStream {
 public:
  /// Where each path comes from, as its emitter was drawn for there; empty where emitters are not
  /// drawn from a tree.
  std::vector<EmitterReceiver> origins;
  std::vector<PathCone> cones;  ///< of each path's ray; empty where textures are read exactly

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<const Ray> rays() const { return {rays_.data(), size_}; }
  [[nodiscard]] std::span<Ray> rays() { return {rays_.data(), size_}; }
  [[nodiscard]] std::span<const PathState> states() const { return {states_.data(), size_}; }
  [[nodiscard]] std::span<PathState> states() { return {states_.data(), size_}; }
  /// The triangle that each ray leaves, or kNoHit.
  [[nodiscard]] std::span<const std::uint32_t> from() const { return {from_.data(), size_}; }
  [[nodiscard]] std::span<std::uint32_t> from() { return {from_.data(), size_}; }

  void push(const Ray& ray, const PathState& state, std::uint32_t from = kNoHit) {
    make_room(size_ + 1);
    rays_[size_] = ray;
    states_[size_] = state;
    from_[size_] = from;
    ++size_;
  }
  void push(const Ray& ray, const PathState& state, std::uint32_t from, const EmitterReceiver& origin) {
    push(ray, state, from);
    origins.push_back(origin);
  }
  /// New rays and states hold anything: they are to be written; they leave no triangle until it is. With `from_places` the places where paths come from
  /// follow.
  void resize(std::size_t size, bool from_places) {
    make_room(size);
    if (size > size_) std::fill(from_.begin() + static_cast<std::ptrdiff_t>(size_), from_.begin() + static_cast<std::ptrdiff_t>(size), kNoHit);
    size_ = size;
    if (from_places) origins.resize(size);
  }
  void clear() {
    size_ = 0;
    origins.clear();
    cones.clear();
  }

 private:
  void make_room(std::size_t size) {
    if (size <= rays_.size()) return;
    rays_.resize(std::max(size, 2 * rays_.size()));
    states_.resize(rays_.size());
    from_.resize(rays_.size());
  }

  /// Longer than size_ once they have been: room is made, and its elements constructed, once.
  std::vector<Ray> rays_;
  std::vector<PathState> states_;
  std::vector<std::uint32_t> from_;
  std::size_t size_ = 0;
};

}  // namespace raykiln::render
