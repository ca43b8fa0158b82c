#include "prepared_scene.hpp"
#include "raykiln/render/limited_tree.hpp"
#include "raykiln/render/prepared_bytes.hpp"

namespace raykiln::render {
namespace {

// No opacity flags: every triangle blocks shadow rays in the seed's model, and a tree that depends
// on geometry alone stays valid when a material changes.
TriangleView triangles_of(const Scene& scene) {
  return {.positions = scene.mesh.positions, .triangles = scene.mesh.triangles, .opaque = {}};
}

}  // namespace

std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene,
                                             std::shared_ptr<const KdTree> tree) {
  return std::make_shared<const PreparedScene>(std::move(scene), std::move(tree));
}

std::size_t prepared_bytes(const PreparedScene& scene) {
  return sizeof(scene) + scene.emitters().bytes() + scene.pyramids().bytes();
}

std::shared_ptr<const KdTree> build_scene_tree(const Scene& scene, const BuildParams& params,
                                               TaskRunner& runner) {
  return build_kdtree(triangles_of(scene), params, runner);
}

std::shared_ptr<const KdTree> build_scene_tree(const Scene& scene, const BuildParams& params,
                                               TaskRunner& runner, const BuildLimits& limits) {
  return build_kdtree(triangles_of(scene), params, runner, limits);
}

std::uint64_t least_tree_bytes(const Scene& scene, const BuildParams& params) {
  return least_bytes(triangles_of(scene), params);
}

double affordable_references(const Scene& scene, const BuildParams& params, const BuildLimits& limits) {
  return affordable_duplication(triangles_of(scene), params, limits);
}

}  // namespace raykiln::render
