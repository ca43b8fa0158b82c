#include <algorithm>
#include <cmath>
#include <cstdio>

#include "raykiln/render/render.hpp"
#include "raykiln/sampling/warp.hpp"

namespace raykiln::render {
namespace {

/// Below this a leaf is as good as a tree, and nobody waits for it.
constexpr double kFewTriangles = 32.0;
constexpr double kManyTriangles = 1000.0;

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

// Expected costs of a random ray, of the tree and of one leaf with everything in it.
bool gives_no_benefit(const BuildStats& tree) {
  const auto n = static_cast<double>(tree.triangles);
  const double ratio = tree.leaf_cost > 0.0 ? tree.sah_cost / tree.leaf_cost : 0.0;
  return (n >= kFewTriangles && ratio >= 0.9) || (n >= kManyTriangles && ratio >= 0.5);
}

// A few crowded cells of a large tree cost nothing that could be seen.
bool budget_matters(const BuildStats& tree) {
  return tree.splits_over_budget > 0 && tree.splits_over_budget >= tree.leaves / 1000;
}

/// 0 where all rays are parallel.
double pixel_solid_angle(const Camera& camera, int height_px) {
  if (camera.projection == Projection::kOrthographic) return 0.0;
  const double side = 2.0 * std::tan(0.5 * camera.fov_y_rad) / height_px;
  return side * side;
}

/// Of a pixel: where a highlight is smaller, a sample finds it with less than this probability.
constexpr double kLeastShare = 1.0 / 16.0;

/// Infinite where there is no lobe. Facets are tilted by up to about alpha = roughness^2, which turns a
/// reflection by twice that.
double lobe_solid_angle(const Material& m) {
  if (m.model == SurfaceModel::kMicrofacet) return 4.0 * kPi * std::pow(m.facets.roughness, 4.0);
  return is_black(m.specular) ? HUGE_VAL : 2.0 * kPi / (m.specular_exp + 1.0);
}

// A lobe of exponent e fills the solid angle 2 pi / (e + 1); the mirror image of a light without a surface is no
// larger. Emitting triangles are found by the path's own rays and do not count.
std::size_t unresolved_mirrors(const RenderSettings& settings, const Scene& scene) {
  const SceneUse use = use_of(scene);
  if (use.lights_without_surface() == 0) return 0;
  const int height = settings.crop ? settings.crop->full_height : settings.height;
  const double least = kLeastShare * pixel_solid_angle(camera_of(settings, scene), height);
  return static_cast<std::size_t>(
      std::count_if(use.materials.begin(), use.materials.end(), [&](std::uint32_t id) {
        const Material& m = scene.materials[id];
        return scatters(m) && lobe_solid_angle(m) < least;
      }));
}

}  // namespace

std::vector<RenderNotice> render_notices(const RenderSettings& settings, const Scene& scene,
                                         const BuildStats& tree) {
  std::vector<RenderNotice> notices;
  if (gives_no_benefit(tree)) {
    notices.push_back({"tree_no_benefit",
                       "the tree gives no benefit here: its expected cost is " + number(tree.sah_cost) +
                           ", that of testing all " + std::to_string(tree.triangles) +
                           " triangles for every ray " + number(tree.leaf_cost)});
  }
  if (budget_matters(tree)) {
    notices.push_back({"tree_budget_reached",
                       "the tree's bound on references or bytes stopped " + std::to_string(tree.splits_over_budget) +
                           " useful splits, at " + std::to_string(tree.references) + " references of " +
                           std::to_string(tree.triangles) +
                           " triangles: the picture is the same, rays may take longer"});
  }
  if (settings.texture_reading == TextureReading::kFootprint && scene.textures != nullptr) {
    notices.push_back({"textures_by_footprint",
                       "textures are read as means over what a pixel covers: less noise, and a bias that no number of "
                       "samples cures and no error bar knows, where light does not depend on them in proportion"});
  }
  if (const std::size_t mirrors = unresolved_mirrors(settings, scene); mirrors > 0) {
    notices.push_back({"unresolved_sharp_highlight",
                       "unresolved sharp highlight: " + std::to_string(mirrors) +
                           " materials mirror lights without a surface in less than 1/16 of a pixel; samples seldom "
                           "find these highlights, so light may be missing where no noise is seen"});
  }
  return notices;
}

}  // namespace raykiln::render
