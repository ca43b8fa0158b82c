#include "raykiln/selftest/whole_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "raykiln/sampling/random.hpp"
#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

/// Uniform numbers of a check, from a fixed key.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : seed_(seed) {}
  double next() {
    return uniform(vertex_key(path_key(seed_, 0, count_++), 0, 0), Dimension::kEnvironmentU);
  }
  float between(double low, double high) { return static_cast<float>(low + (high - low) * next()); }

 private:
  std::uint64_t seed_, count_ = 0;
};

std::shared_ptr<const KdTree> tree_of(const Scene& scene) {
  SerialTaskRunner runner;
  return build_scene_tree(scene, {}, runner);
}

Scene furnace(double albedo) {
  SmallScene s;
  const auto wall = s.material(matte(static_cast<float>(albedo), static_cast<float>(1.0 - albedo)));
  s.box(Vec3f(-1), Vec3f(1), wall, true);
  s.look({0.1, 0.2, 0.3}, {1, 0.3, 0.1}, {0, 0, 1}, 1.2);
  return s.scene();
}

RenderSettings small_picture() {
  RenderSettings settings;
  settings.width = 24;
  settings.height = 18;
  settings.max_depth = 6;
  return settings;
}

std::uint64_t room_hash(const Scene& scene, const RenderSettings& settings, const BuildParams& params = {}) {
  return bit_hash(render_film(scene, settings, 4, nullptr, params));
}

Outcome all_equal(int equal, int all) {
  return {equal == all, "equal " + std::to_string(equal) + " of " + std::to_string(all)};
}

Outcome never(std::size_t events, std::size_t trials, const char* what) {
  return {events == 0, std::string(what) + " " + std::to_string(events) + " of " + std::to_string(trials)};
}

}  // namespace

Scene room_of_all_kinds() {
  SmallScene s;
  Material wall = matte(0.5F);
  wall.diffuse = {0.6F, 0.5F, 0.3F};
  s.box(Vec3f(-1), Vec3f(1), s.material(wall), true);
  Material lamp = matte(0.1F);
  lamp.emission = {5.0F, 4.0F, 7.0F};
  s.level_square(0.3F, 0.91F, s.material(lamp), false);
  s.box({-0.6F, -0.5F, -0.7F}, {-0.1F, 0.1F, 0.2F}, s.material(clear_glass(1.5F)));
  Material gloss = matte(0.3F);
  gloss.specular = {0.3F, 0.4F, 0.2F};
  gloss.specular_exp = 200.0;
  s.box({0.2F, 0.1F, -0.8F}, {0.7F, 0.6F, 0.1F}, s.material(gloss));
  Material sheet = matte(0.6F);
  sheet.transparent = 0.5F;
  s.triangle({-0.8F, 0.7F, -0.5F}, {0.1F, 0.8F, -0.4F}, {-0.3F, 0.6F, 0.6F}, s.material(sheet));
  s.point_light({-0.71F, 0.43F, 0.67F}, {0.3F, 0.2F, 0.1F});
  s.look({0.13, -0.93, 0.31}, {-0.1, 0.4, -0.2}, {0, 0, 1}, 1.3);
  return s.scene();
}

Outcome white_furnace(double albedo, const LightModel& model) {
  RenderSettings settings = small_picture();
  settings.light_model = model;
  // So deep that what is cut off, albedo^(depth + 1), is below the tolerance.
  settings.max_depth = static_cast<int>(std::ceil(std::log(1e-7) / std::log(albedo)));
  return statistically(measure(furnace(albedo), settings, 64), 1.0, 2e-6);
}

Outcome truncated_furnace(double albedo, int depth) {
  RenderSettings settings = small_picture();
  settings.light_model.roulette = false;
  settings.max_depth = depth;
  settings.emitter_sampling = false;
  return exact_to(measure(furnace(albedo), settings, 1), 1.0 - std::pow(albedo, depth + 1), 1e-5);
}

Outcome coplanar_wall(int rays) {
  SmallScene s;
  const auto white = s.material(matte(0.5F));
  s.box(Vec3f(-3), Vec3f(3), white, true);
  constexpr int kCells = 30;
  const auto at = [](int i) { return -3.0F + 6.0F * static_cast<float>(i) / kCells; };
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      s.quad({Vec3f(1.7F, at(i), at(j)), {1.7F, at(i), at(j + 1)}, {1.7F, at(i + 1), at(j + 1)},
              {1.7F, at(i + 1), at(j)}}, white);
    }
  }
  Numbers numbers(101);
  std::vector<Ray> stream(static_cast<std::size_t>(rays));
  for (Ray& ray : stream) {
    ray.o = {numbers.between(-1, 1), numbers.between(-1, 1), numbers.between(-1, 1)};
    ray.d = {numbers.between(0.001, 1), numbers.between(-1, 1), numbers.between(-1, 1)};
  }
  const auto tree = tree_of(s.scene());
  std::vector<Hit> fast(stream.size()), slow(stream.size());
  closest_hits(*tree, stream, fast);
  closest_hits(*tree, stream, slow, {}, Traversal::kBruteForce);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    wrong += fast[i].id == kNoHit || fast[i].id != slow[i].id || fast[i].t != slow[i].t ? 1 : 0;
  }
  return never(wrong, stream.size(), "missed or unlike brute force");
}

// A sphere of triangles whose corners are random points on it in rows; aimed at from inside.
Outcome sealed_edges(int rays) {
  constexpr int kRows = 24, kColumns = 48;
  Numbers numbers(102);
  SmallScene s;
  const auto white = s.material(matte(0.5F));
  std::vector<Vec3f> grid;
  for (int r = 0; r <= kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const bool pole = r == 0 || r == kRows;
      const double polar = pole ? 3.14159265358979 * r / kRows
                                : 3.14159265358979 * (r + 0.4 * (numbers.next() - 0.5)) / kRows;
      const double turn = 6.28318530717959 * (c + 0.4 * (numbers.next() - 0.5)) / kColumns;
      grid.push_back(pole ? Vec3f(0, 0, r == 0 ? 1 : -1)
                          : Vec3f(Vec3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                                        std::cos(polar))));
    }
  }
  const auto at = [&](int r, int c) { return grid[static_cast<std::size_t>(r * kColumns + c % kColumns)]; };
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      s.triangle(at(r, c), at(r + 1, c), at(r + 1, c + 1), white);
      s.triangle(at(r, c), at(r + 1, c + 1), at(r, c + 1), white);
    }
  }
  const auto& mesh = s.scene().mesh;
  std::vector<Ray> stream(static_cast<std::size_t>(rays));
  for (Ray& ray : stream) {
    const auto id = static_cast<std::size_t>(numbers.next() * static_cast<double>(mesh.triangles.size()));
    const auto side = static_cast<std::size_t>(numbers.next() * 3.0);
    const Vec3f a = mesh.positions[mesh.triangles[id][side]], b = mesh.positions[mesh.triangles[id][(side + 1) % 3]];
    const float along = numbers.next() < 0.3 ? 0.0F : numbers.between(0, 1);
    ray.o = {numbers.between(-0.5, 0.5), numbers.between(-0.5, 0.5), numbers.between(-0.5, 0.5)};
    ray.d = a + along * (b - a) - ray.o;
  }
  const auto tree = tree_of(s.scene());
  std::vector<Hit> hits(stream.size());
  closest_hits(*tree, stream, hits);
  const auto misses = std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.id == kNoHit; });
  return never(static_cast<std::size_t>(misses), stream.size(), "leaks");
}

Outcome same_at_any_scale() {
  const Scene room = room_of_all_kinds();
  const std::uint64_t hash = room_hash(room, small_picture());
  int equal = 0;
  for (const int k : {-30, -10, 10, 30}) {
    Scene other = room;
    const float scale = std::ldexp(1.0F, k);
    for (Vec3f& p : other.mesh.positions) p *= scale;
    for (PointLight& light : other.point_lights) {
      light.position *= scale;
      light.intensity *= scale * scale;
    }
    for (Camera& camera : other.cameras) camera.eye *= static_cast<double>(scale);
    other.bounds = {other.bounds.lo * scale, other.bounds.hi * scale};
    equal += room_hash(other, small_picture()) == hash ? 1 : 0;
  }
  return all_equal(equal, 4);
}

Outcome same_for_any_tree() {
  const Scene room = room_of_all_kinds();
  RenderSettings settings = small_picture();
  const std::uint64_t hash = room_hash(room, settings);
  int equal = 0, all = 0;
  for (const int depth : {0, 1, 8, 64}) {
    for (const double ratio : {0.1, 1.0, 10.0}) {
      const BuildParams params{.k_t = ratio, .k_i = 1.0, .max_depth = depth};
      equal += room_hash(room, settings, params) == hash ? 1 : 0;
      ++all;
    }
  }
  settings.traversal = Traversal::kBruteForce;
  equal += room_hash(room, settings) == hash ? 1 : 0;
  return all_equal(equal, all + 1);
}

Outcome linear_in_light() {
  const Scene room = room_of_all_kinds();
  const auto plain = render_film(room, small_picture(), 4).plane("beauty");
  int equal = 0;
  for (const int k : {-40, -3, 1, 40}) {
    Scene bright = room;
    const float scale = std::ldexp(1.0F, k);
    for (Material& material : bright.materials) material.emission *= scale;
    for (PointLight& light : bright.point_lights) light.intensity *= scale;
    const auto scaled = render_film(bright, small_picture(), 4).plane("beauty");
    equal += std::equal(plain.begin(), plain.end(), scaled.begin(), scaled.end(),
                        [k](double x, double y) { return std::ldexp(x, k) == y; }) ? 1 : 0;
  }
  return all_equal(equal, 4);
}

Outcome bad_samples_counted() {
  volatile double zero = 0.0;  // so that nothing is known before the program runs
  const double nan = zero / zero, inf = 1.0 / zero;
  PlaneSet planes = make_block_planes(1);
  for (int i = 0; i < 1000; ++i) {
    add_sample(planes, 0, Rgbd(0.5), false);
    add_sample(planes, 0, Rgbd(0.5, nan, 0.5), false);
    add_sample(planes, 0, Rgbd(i % 2 == 0 ? inf : -inf, 0.5, 0.5), false);
  }
  const auto at = [&](BlockPlane::Index plane) { return planes.planes[plane][0]; };
  const bool right = at(BlockPlane::kSamples) == 1000.0 && at(BlockPlane::kNan) == 1000.0 &&
                     at(BlockPlane::kInf) == 1000.0 && at(BlockPlane::kBeauty) == 500.0;
  return {right && std::isnan(nan), "kept " + text(at(BlockPlane::kSamples)) + ", NaN " +
                                        text(at(BlockPlane::kNan)) + ", infinite " + text(at(BlockPlane::kInf))};
}

Outcome a_million_samples() {
  Film film(1, 1);
  constexpr std::uint64_t kSamples = 1'000'000;
  double error = 0.0;
  for (const SampleBlock& block : blocks_for(kSamples)) {
    BlockResult result{block, make_block_planes(1)};
    for (std::uint64_t i = 0; i < block.count; ++i) add_sample(result.planes, 0, Rgbd(1.0), false);
    film.fold({0, 0, 1, 1}, result);
  }
  error = std::abs(film.plane("beauty")[0] / static_cast<double>(kSamples) - 1.0);
  return {error <= 1e-12, "relative error " + text(error)};
}

Outcome variance_of_close_samples() {
  Film film(1, 1);
  constexpr std::uint64_t kSamples = 100'000;
  std::uint64_t count = 0;
  for (const SampleBlock& block : blocks_for(kSamples)) {
    BlockResult result{block, make_block_planes(1)};
    for (std::uint64_t i = 0; i < block.count; ++i) {
      add_sample(result.planes, 0, Rgbd(count++ % 2 == 0 ? 1000.01 : 999.99), false);
    }
    film.fold({0, 0, 1, 1}, result);
  }
  const double variance = film.plane("luminance_moment")[0] / static_cast<double>(kSamples);
  const double error = std::abs(variance / 1e-4 - 1.0);
  return {error <= 1e-6, "variance " + text(variance) + ", relative error " + text(error)};
}

}  // namespace raykiln::render::selftest
