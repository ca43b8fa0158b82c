// Paths that are under way: rays apart from the rest, as the tree wants them.
#pragma once

#include <cstdint>
#include <vector>

#include "raykiln/math/ray.hpp"
#include "raykiln/integrator/camera_ray.hpp"
#include "raykiln/sampling/random.hpp"
#include "raykiln/shading/light_tree.hpp"

namespace raykiln::render {

/// What a path carries besides its ray.
struct PathState {
  PathKey key;
  Rgbd throughput{1.0};
  /// What of the throughput is no loss: changes of medium, and one over the rays shot with it.
  double scale = 1.0;
  double pdf = 0.0;          ///< of the ray's direction times the rays shot with it, sr^-1
  std::uint64_t node = 0;    ///< number of the branch among those of its bounce
  std::uint32_t slot = 0;    ///< index of its PathResult
  std::uint16_t bounce = 0;  ///< reflections so far
  bool met_diffuse = false;  ///< one of them was diffuse; kept where caustics are left out alone
};

struct PathStream {
  std::vector<Ray> rays;
  std::vector<PathState> states;
  /// Where each path comes from, as its emitter was drawn for there; empty where emitters are not
  /// drawn from a tree.
  std::vector<EmitterReceiver> origins;
  std::vector<PathCone> cones;  ///< of each path's ray; empty where textures are read exactly

  [[nodiscard]] std::size_t size() const { return rays.size(); }
  void push(const Ray& ray, const PathState& state) {
    rays.push_back(ray);
    states.push_back(state);
  }
  void push(const Ray& ray, const PathState& state, const EmitterReceiver& origin) {
    push(ray, state);
    origins.push_back(origin);
  }
  /// With `from_places` the places where paths come from follow.
  void resize(std::size_t size, bool from_places) {
    rays.resize(size);
    states.resize(size);
    if (from_places) origins.resize(size);
  }
  void clear() {
    rays.clear();
    states.clear();
    origins.clear();
    cones.clear();
  }
};

}  // namespace raykiln::render
