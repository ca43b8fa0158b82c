#include "raykiln/base/sha256.hpp"
#include "raykiln/workers/scene_cache.hpp"

namespace raykiln::server {
namespace {

template <class Element>
void feed(Sha256& hash, const std::vector<Element>& elements) {
  const std::uint64_t count = elements.size();
  hash.update(std::as_bytes(std::span(&count, 1)));
  hash.update(std::as_bytes(std::span(elements)));
}

}  // namespace

std::string geometry_digest(const render::Scene& scene) {
  Sha256 hash;
  feed(hash, scene.mesh.positions);
  feed(hash, scene.mesh.triangles);
  // render::build_scene_tree gives no opacity flags today. Were it to do so, they belong here.
  feed(hash, std::vector<std::uint8_t>());
  return to_hex(hash.finish());
}

}  // namespace raykiln::server
