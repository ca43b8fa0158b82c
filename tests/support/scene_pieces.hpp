// Small scenes put together by hand, for tests and benchmarks of light transport.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "raykiln/render/render.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::support {

inline Material diffuse_material(const Rgb& albedo, const Rgb& emission = Rgb(0.0F)) {
  Material material;
  material.diffuse = albedo;
  material.emission = emission;
  return material;
}

inline Material mirror_material(float reflectance, double exponent) {
  Material material;
  material.specular = Rgb(reflectance);
  material.specular_exp = exponent;
  return material;
}

inline Material glass_material(float index, double exponent) {
  Material material = mirror_material(1.0F, exponent);
  material.transparent = 1.0F;
  material.index_of_refraction = index;
  return material;
}

/// The product's own builder of small scenes, which also hands out the prepared one.
class SceneBuilder : public selftest::SmallScene {
 public:
  /// A camera at `eye` that looks at `target`, beside those there are; `up` must not be parallel to
  /// that.
  void camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_y_rad) {
    std::vector<Camera> cameras = scene().cameras;
    look(eye, target, up, fov_y_rad);
    cameras.push_back(scene().cameras.front());
    scene().cameras = std::move(cameras);
  }

  [[nodiscard]] std::shared_ptr<const PreparedScene> prepare(const BuildParams& params = {}) const {
    auto shared = std::make_shared<const Scene>(scene());
    SerialTaskRunner runner;
    return render::prepare(shared, build_scene_tree(*shared, params, runner));
  }
};

/// A closed room of two coloured walls with a light in the ceiling, a glass and a mirror box and a
/// point light: every kind of surface and light at once. Seen from inside.
inline SceneBuilder mixed_room(double sharp_exponent = 1e10) {
  SceneBuilder b;
  const auto white = b.material(diffuse_material(Rgb(0.7F)));
  const auto red = b.material(diffuse_material({0.6F, 0.1F, 0.1F}));
  const auto green = b.material(diffuse_material({0.1F, 0.6F, 0.1F}));
  const auto lamp = b.material(diffuse_material(Rgb(0.0F), {12.0F, 10.0F, 7.0F}));
  const auto glass = b.material(glass_material(1.5F, sharp_exponent));
  Material gloss = mirror_material(0.4F, 200.0);
  gloss.diffuse = Rgb(0.3F);
  const auto glossy = b.material(gloss);
  b.quad({Vec3f(-1, -1, -1), {-1, -1, 1}, {1, -1, 1}, {1, -1, -1}}, glossy);
  b.quad({Vec3f(-1, 1, -1), {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, white);
  b.quad({Vec3f(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, white);
  b.quad({Vec3f(-1, -1, 1), {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}, white);
  b.quad({Vec3f(-1, -1, -1), {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1}}, red);
  b.quad({Vec3f(1, -1, -1), {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}, green);
  b.quad({Vec3f(-0.3F, 0.99F, -0.3F), {0.3F, 0.99F, -0.3F}, {0.3F, 0.99F, 0.3F}, {-0.3F, 0.99F, 0.3F}},
         lamp);
  b.box({0.1F, -0.99F, -0.1F}, {0.6F, -0.4F, 0.4F}, glass);
  b.box({-0.7F, -0.99F, -0.6F}, {-0.2F, 0.2F, -0.1F}, b.material(mirror_material(0.9F, sharp_exponent)));
  b.point_light({-0.5F, 0.5F, 0.5F}, Rgb(0.3F));
  b.camera({0.0F, 0.0F, 0.95F}, {0.0F, -0.2F, -1.0F}, {0, 1, 0}, 1.2F);
  return b;
}

/// Renders the whole picture on this thread, all blocks of a tile in one task.
inline TileResult render_all(const PreparedScene& scene, const RenderSettings& settings,
                             std::uint64_t samples) {
  const auto blocks = blocks_for(samples);
  return render_tile(scene, settings, {0, 0, settings.width, settings.height}, blocks, {});
}

/// Mean of the three channels' sums over all pixels and samples, and the standard error of the
/// luminance mean from the spread between samples.
struct Estimate {
  Rgbd mean{0.0};
  double standard_error = 0.0;
  double samples = 0.0;
};

inline Estimate estimate(const TileResult& result) {
  Film film(result.rect.x1, result.rect.y1);
  merge(film, result);
  Estimate e;
  const auto beauty = film.plane("beauty");
  const auto counts = film.plane("samples");
  const auto moments = film.plane("luminance_moment");
  double variance = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    e.mean += Rgbd(beauty[3 * i], beauty[3 * i + 1], beauty[3 * i + 2]);
    e.samples += counts[i];
    if (counts[i] > 1.0) variance += counts[i] * moments[i] / (counts[i] - 1.0);
  }
  e.mean /= e.samples;
  e.standard_error = std::sqrt(variance) / e.samples;
  return e;
}

}  // namespace raykiln::render::support
