// Traces frozen rays through frozen scenes, one call of trace_rays for each line that it prints:
// "scene rays kernel count". instruction_gates.py counts the instructions of the calls.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bench/accel/bench_scenes.hpp"
#include "bench/accel/ray_sets.hpp"
#include "raykiln/accel/kernels.hpp"

using raykiln::render::Hit;
using raykiln::render::KdTree;
using raykiln::render::Occlusion;
using raykiln::render::Ray;
using raykiln::render::Traversal;

// Found by its name. `hits` or else `found` gets the answers.
extern "C" [[gnu::noinline]] void trace_rays(const KdTree& tree, const std::vector<Ray>& rays,
                                             std::vector<Hit>* hits, std::vector<Occlusion>* found,
                                             Traversal kernel) {
  if (hits != nullptr) raykiln::render::closest_hits(tree, rays, *hits, {}, kernel);
  if (found != nullptr) raykiln::render::any_hits(tree, rays, *found, kernel);
}

namespace {

void measure(const std::string& name, const KdTree& tree, const std::vector<Ray>& rays,
             std::vector<Hit>* hits, std::vector<Occlusion>* found) {
  for (const Traversal kernel : {Traversal::kScalar, Traversal::kAvx2, Traversal::kFastScalar,
                                 Traversal::kFastAvx2}) {
    if (!raykiln::render::is_available(kernel)) continue;
    trace_rays(tree, rays, hits, found, kernel);
    const std::string kernel_name(raykiln::render::name(kernel));
    std::printf("%s %s %zu\n", name.c_str(), kernel_name.c_str(), rays.size());
  }
}

}  // namespace

int main() {
  raykiln::render::SerialTaskRunner runner;
  for (const std::string family : {"terrain", "soup", "city", "room"}) {
    const auto mesh = raykiln::bench::make_mesh(family, 6'000, 1);
    const auto tree = raykiln::render::build_kdtree(mesh->view(), {}, runner);
    if (!tree) return EXIT_FAILURE;
    const raykiln::render::Bounds3f box = raykiln::render::bounds(*tree);
    const auto primary = raykiln::bench::primary_rays(box, 64, 1);
    std::vector<Hit> hits(primary.size());
    measure(family + " primary", *tree, primary, &hits, nullptr);
    const auto points = raykiln::bench::surface_points(*mesh, primary, hits);
    const auto diffuse = raykiln::bench::cosine_bounces(points, 2);
    std::vector<Hit> bounced(diffuse.size());
    measure(family + " diffuse", *tree, diffuse, &bounced, nullptr);
    const auto shadow = raykiln::bench::shadow_rays(points, box, 3);
    std::vector<Occlusion> found(shadow.size());
    measure(family + " shadow", *tree, shadow, nullptr, &found);
  }
  return EXIT_SUCCESS;
}
