#include "raykiln/scene/scene.hpp"

#include <algorithm>

namespace raykiln::render {

std::uint32_t object_of(const TriangleMesh& mesh, std::uint32_t id) {
  const auto after = std::upper_bound(mesh.objects.begin(), mesh.objects.end(), id,
                                      [](std::uint32_t triangle, const ObjectRun& run) { return triangle < run.first; });
  return after == mesh.objects.begin() ? 0 : std::prev(after)->object;
}

}  // namespace raykiln::render
