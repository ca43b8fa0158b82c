#include "prepared_scene.hpp"
#include "raykiln/render/prepared_bytes.hpp"

namespace raykiln::render {

std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene,
                                             std::shared_ptr<const KdTree> tree) {
  return std::make_shared<const PreparedScene>(std::move(scene), std::move(tree));
}

std::size_t prepared_bytes(const PreparedScene& scene) {
  return sizeof(scene) + scene.emitters().bytes() + scene.pyramids().bytes();
}

// No opacity flags: every triangle blocks shadow rays in the seed's model, and a tree that depends
// on geometry alone stays valid when a material changes.
std::shared_ptr<const KdTree> build_scene_tree(const Scene& scene, const BuildParams& params,
                                               TaskRunner& runner) {
  return build_kdtree(
      {.positions = scene.mesh.positions, .triangles = scene.mesh.triangles, .opaque = {}}, params,
      runner);
}

}  // namespace raykiln::render
