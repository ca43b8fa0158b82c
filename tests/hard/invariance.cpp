// X01-X06: what must not change a picture, or must change it in a known way.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>
#include <numeric>
#include <thread>

#include "hard/support/members.hpp"
#include "hard/support/models.hpp"
#include "hard/support/pictures.hpp"
#include "hard/support/pool_pictures.hpp"
#include "hard/support/random_rooms.hpp"
#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"
#include "raykiln/selftest/measure.hpp"

namespace raykiln::hard {
namespace {

using namespace render;
using selftest::render_film;

constexpr std::uint64_t kSamples = 8;

std::uint64_t hash_of(const Scene& scene, const RenderSettings& settings,
                      const BuildParams& params = {}) {
  return selftest::bit_hash(render_film(scene, settings, kSamples, nullptr, params));
}

/// Equal planes count, and a picture that is all black proves nothing.
class Equalities {
 public:
  void check(bool equal, const std::string& what) {
    EXPECT_TRUE(equal) << what;
    ++checked_;
    equal_ += equal ? 1 : 0;
  }
  void report(Row& row) const { row.measured("equal", shown(equal_) + " of " + shown(checked_)); }

 private:
  std::uint64_t checked_ = 0, equal_ = 0;
};

Scene scaled(Scene scene, int k) {
  const float s = std::ldexp(1.0F, k);
  for (Vec3f& p : scene.mesh.positions) p *= s;
  for (PointLight& light : scene.point_lights) {
    light.position *= s;
    light.intensity *= s * s;
  }
  for (Camera& camera : scene.cameras) camera.eye *= static_cast<double>(s);
  scene.bounds = {scene.bounds.lo * s, scene.bounds.hi * s};
  return scene;
}

TEST(X01, ScaleByPowersOfTwo) {
  Members members(4001);
  Row row("X01", "random rooms times 2^k, k = -30, -10, 10, 30" + members.note(), "bit-identical planes", "both");
  Equalities equalities;
  for (std::size_t i = 0; i < 6; ++i) {
    const Scene scene = random_room(members);
    const RenderSettings settings = room_settings(members.bits(), model_of(i));
    const std::uint64_t hash = hash_of(scene, settings);
    for (const int k : {-30, -10, 10, 30}) {
      equalities.check(hash == hash_of(scaled(scene, k), settings),
                       "room " + std::to_string(i) + ", k " + std::to_string(k));
    }
  }
  equalities.report(row);
}

std::vector<PixelRect> rects_of(const RenderSettings& settings, int pixels) {
  std::vector<PixelRect> rects;
  for (int y = 0; y < settings.height; ++y) {
    for (int x = 0; x < settings.width; x += pixels) {
      rects.push_back({x, y, std::min(x + pixels, settings.width), y + 1});
    }
  }
  return rects;
}

void shuffle(std::vector<PixelRect>& rects, Members& members) {
  for (std::size_t i = rects.size(); i > 1; --i) std::swap(rects[i - 1], rects[members.bits() % i]);
}

Film by_threads(const PreparedScene& scene, const RenderSettings& settings,
                const std::vector<PixelRect>& rects, std::span<const SampleBlock> blocks, int n) {
  Film film(settings.width, settings.height);
  std::mutex mutex;
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> threads;
  for (int t = 0; t < n; ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < rects.size(); i = next++) {
        const TileResult result = render_tile(scene, settings, rects[i], blocks, {});
        const std::lock_guard lock(mutex);
        merge(film, result);
      }
    });
  }
  threads.clear();
  return film;
}

TEST(X02, ThreadCountAndSchedule) {
  Members members(4002);
  Row row("X02", "1, 2, 7, 64 threads, groups of 1, 16, 1000 pixels in random order, stopped and resumed" +
                     members.note(), "bit-identical planes", "both");
  Equalities equalities;
  const Scene scene = random_room(members);
  const auto ready = prepared(scene);
  const auto blocks = blocks_for(21);
  std::size_t turn = 0;
  for (const int n : {1, 2, 7, 64}) {
    for (const int group : {1, 16, 1000}) {
      const RenderSettings settings = room_settings(4002, model_of(turn++));
      const std::uint64_t hash = selftest::bit_hash(render_film(scene, settings, 21));
      auto rects = rects_of(settings, group);
      shuffle(rects, members);
      const std::string what = std::to_string(n) + " threads, groups of " + std::to_string(group);
      equalities.check(hash == selftest::bit_hash(by_threads(*ready, settings, rects, blocks, n)), what);
      // Stopped after some blocks, resumed with others.
      Film film(settings.width, settings.height);
      const std::size_t cut = 1 + members.bits() % (blocks.size() - 1);
      for (const auto part : {std::span(blocks).first(cut), std::span(blocks).subspan(cut)}) {
        shuffle(rects, members);
        for (const PixelRect& rect : rects) merge(film, render_tile(*ready, settings, rect, part, {}));
      }
      equalities.check(hash == selftest::bit_hash(film), what + ", resumed");
    }
  }
  equalities.report(row);
}

TEST(X02, ServerPool) {
  Members members(4012);
  Row row("X02", "the server's pool of 1, 2, 7, 64 threads" + members.note(), "bit-identical planes", "both");
  Equalities equalities;
  for (const LightModel& model : kBothModels) {
    const Scene scene = random_room(members);
    const RenderSettings settings = room_settings(members.bits(), model);
    const auto ready = prepared(scene);
    const std::uint64_t hash = selftest::bit_hash(render_film(scene, settings, kSamples));
    for (const int n : {1, 2, 7, 64}) {
      auto rects = rects_of(settings, 5);
      shuffle(rects, members);
      const Film film = film_by_pool(ready, settings, kSamples, n, rects);
      equalities.check(hash == selftest::bit_hash(film), std::to_string(n) + " threads, " + name(model));
    }
  }
  equalities.report(row);
}

// Emitting triangles keep their order among themselves: it decides which of them a number draws.
Scene shuffled(const Scene& scene, Members& members) {
  const auto emits = [&](std::uint32_t t) {
    return scene.materials[scene.mesh.material_ids[t]].emission != Rgb(0.0F);
  };
  std::vector<std::uint32_t> order(scene.mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[members.bits() % i]);
  std::vector<std::uint32_t> emitters;
  std::copy_if(order.begin(), order.end(), std::back_inserter(emitters), emits);
  std::sort(emitters.begin(), emitters.end());
  auto next = emitters.begin();
  for (std::uint32_t& t : order) {
    if (emits(t)) t = *next++;
  }
  Scene result = scene;
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.mesh.triangles[i] = scene.mesh.triangles[order[i]];
    result.mesh.material_ids[i] = scene.mesh.material_ids[order[i]];
  }
  return result;
}

TEST(X03, TheTreeMustNotChangeTheImage) {
  Members members(4003);
  Row row("X03", "depths 0, 1, 8, 64, K_t/K_i 0.1, 1, 10, leaves of 8 and 16, brute force, shuffled triangles" +
                     members.note(), "bit-identical planes", "both");
  Equalities equalities;
  for (std::size_t i = 0; i < 4; ++i) {
    const Scene scene = random_room(members, 3, 120);
    RenderSettings settings = room_settings(members.bits(), model_of(i));
    const std::uint64_t hash = hash_of(scene, settings);
    const std::string room = "room " + std::to_string(i) + ", ";
    for (const int depth : {0, 1, 8, 64}) {
      for (const double ratio : {0.1, 1.0, 10.0}) {
        const int width = ratio > 1.0 ? 16 : 8;
        const BuildParams params{.k_t = ratio, .k_i = 1.0, .max_depth = depth, .leaf_width = width};
        equalities.check(hash == hash_of(scene, settings, params),
                         room + "depth " + std::to_string(depth) + ", ratio " + shown(ratio));
      }
    }
    for (int n = 0; n < 3; ++n) {
      equalities.check(hash == hash_of(shuffled(scene, members), settings), room + "shuffled");
    }
    settings.traversal = Traversal::kBruteForce;
    equalities.check(hash == hash_of(scene, settings), room + "brute force");
  }
  equalities.report(row);
}

bool scaled_exactly(const std::vector<double>& a, const std::vector<double>& b, int k) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [k](double x, double y) { return std::ldexp(x, k) == y; });
}

TEST(X04, AllLightTimesAPowerOfTwo) {
  Members members(4004);
  Row row("X04", "all emission and intensities times 2^k, k = -40 .. 40" + members.note(),
          "picture times 2^k bit for bit", "both");
  Equalities equalities;
  for (std::size_t i = 0; i < 4; ++i) {
    const Scene scene = random_room(members);
    const RenderSettings settings = room_settings(members.bits(), model_of(i));
    const auto plain = render_film(scene, settings, kSamples).plane("beauty");
    for (const int k : {-40, -17, -1, 1, 23, 40}) {
      Scene bright = scene;
      const float s = std::ldexp(1.0F, k);
      for (Material& material : bright.materials) material.emission *= s;
      for (PointLight& light : bright.point_lights) light.intensity *= s;
      equalities.check(scaled_exactly(plain, render_film(bright, settings, kSamples).plane("beauty"), k),
                       "room " + std::to_string(i) + ", k " + std::to_string(k));
    }
  }
  equalities.report(row);
}

TEST(X04, SumOfTwoLights) {
  Members members(4014);
  Row row("X04", "picture of two point lights against the sum of the pictures of each" + members.note(),
          "relative n 2^-53 + 4u", "both");
  double worst = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    Scene both = random_room(members);
    for (Material& material : both.materials) material.emission = Rgb(0.0F);
    const RenderSettings settings = room_settings(members.bits(), model_of(i));
    Scene a = both, b = both;
    a.point_lights.pop_back();
    b.point_lights.erase(b.point_lights.begin());
    const auto x = render_film(both, settings, kSamples).plane("beauty"),
               y = render_film(a, settings, kSamples).plane("beauty"),
               z = render_film(b, settings, kSamples).plane("beauty");
    double sum = 0.0;
    for (std::size_t p = 0; p < x.size(); ++p) {
      sum += x[p];
      if (x[p] > 0.0) worst = std::max(worst, std::abs(y[p] + z[p] - x[p]) / x[p]);
    }
    EXPECT_GT(sum, 0.0);
  }
  row.measured("largest relative difference", worst);
  EXPECT_LE(worst, kSamples * 0x1p-53 + 4.0 * kUnit);
}

using Turn = std::array<Vec3d, 3>;  // rows

Vec3d turned(const Turn& turn, const Vec3d& v) {
  return {dot(turn[0], v), dot(turn[1], v), dot(turn[2], v)};
}

Turn about(int axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  if (axis == 0) return {Vec3d(1, 0, 0), Vec3d(0, c, -s), Vec3d(0, s, c)};
  if (axis == 1) return {Vec3d(c, 0, s), Vec3d(0, 1, 0), Vec3d(-s, 0, c)};
  return {Vec3d(c, -s, 0), Vec3d(s, c, 0), Vec3d(0, 0, 1)};
}

Scene moved(Scene scene, const std::vector<Turn>& turns, const Vec3d& shift) {
  const auto turn = [&](const auto& v) {
    Vec3d w(v);
    for (const Turn& t : turns) w = turned(t, w);
    return w;
  };
  scene.bounds = {};
  for (Vec3f& p : scene.mesh.positions) {
    p = Vec3f(turn(p) + shift);
    scene.bounds.grow(p);
  }
  for (PointLight& light : scene.point_lights) light.position = Vec3f(turn(light.position) + shift);
  for (Camera& c : scene.cameras) {
    c.eye = turn(c.eye) + shift;
    c.right = turn(c.right);
    c.up = turn(c.up);
    c.forward = turn(c.forward);
  }
  return scene;
}

std::vector<PixelEstimate> estimates(const Film& film) {
  const auto beauty = film.plane("beauty"), counts = film.plane("samples"),
             moments = film.plane("luminance_moment");
  std::vector<PixelEstimate> result;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double n = counts[i];
    result.push_back({luminance({beauty[3 * i], beauty[3 * i + 1], beauty[3 * i + 2]}) / n,
                      moments[i] / (n - 1.0) / n});
  }
  return result;
}

struct Motion {
  std::string name;
  std::vector<Turn> turns;
  Vec3d shift;
};

std::vector<Motion> motions() {
  const double right = 2.0 * std::atan(1.0);
  return {{"90 degrees about x", {about(0, right)}, Vec3d(0)},
          {"90 degrees about y", {about(1, right)}, Vec3d(0)},
          {"90 degrees about z", {about(2, right)}, Vec3d(0)},
          {"(0.3, 0.7, 1.1) rad", {about(0, 0.3), about(1, 0.7), about(2, 1.1)}, Vec3d(0)},
          {"by (1024, -512, 256)", {}, Vec3d(1024, -512, 256)},
          {"by (1234.567, -765.4321, 98.7654)", {}, Vec3d(1234.567, -765.4321, 98.7654)}};
}

// Diffuse surfaces: per-pixel z-tests want noise without heavy tails.
TEST(X05, RotationAndTranslation) {
  Members members(4005);
  Row row("X05", "a room turned and moved, against itself with another seed" + members.note(),
          "99.75 % of the pixels in the Sidak band, global mean within 4 sigma; background seen from the closed room: 0", "both");
  Scene scene = random_room(members, 4, 0);
  for (Material& material : scene.materials) {
    material.specular = Rgb(0.0F);
    material.transparent = 0.0F;
    if (material.diffuse == Rgb(0.0F)) material.diffuse = Rgb(0.4F);
  }
  const std::uint64_t samples = tests::kSanitized ? 64 : trials(384, 4096);
  std::array<std::vector<PixelEstimate>, 2> references;
  for (std::size_t i = 0; i < 2; ++i) {
    references[i] = estimates(render_film(scene, room_settings(members.bits(), model_of(i)), samples));
  }
  std::size_t turn = 0;
  double least = 1.0, largest_z = 0.0;
  std::uint64_t leaks = 0, rays = 0;
  for (const Motion& motion : motions()) {
    const auto& reference = references[turn % 2];
    const RenderSettings settings = room_settings(members.bits(), model_of(turn++));
    const Scene other = moved(scene, motion.turns, motion.shift);
    RenderStats stats;
    const auto compared = compare_images(reference, estimates(render_film(other, settings, samples, &stats)));
    EXPECT_TRUE(compared.equal()) << motion.name << ": " << compared.accepted_share << ' ' << compared.mean_z;
    EXPECT_EQ(stats.non_finite, 0U) << motion.name;
    least = std::min(least, compared.accepted_share);
    largest_z = std::max(largest_z, std::abs(compared.mean_z));
    // The same room without lamps before a bright background: what is not black has leaked.
    Scene dark = other;
    for (Material& material : dark.materials) material.emission = Rgb(0.0F);
    dark.point_lights.clear();
    dark.background = Rgb(1.0F);
    const Film film = render_film(dark, settings, 64, &stats);
    for (const double value : film.plane("largest")) leaks += value > 0.0 ? 1 : 0;
    rays += stats.camera_rays + stats.bounce_rays;
  }
  row.measured("least share of pixels", least);
  row.measured("largest |z| of the mean", largest_z);
  row.measured("rays in the dark room", rays);
  row.measured("pixels that leaked", leaks);
  EXPECT_EQ(leaks, 0U);
}

Rgb permuted(const Rgb& c, const std::array<int, 3>& p) { return {c[p[0]], c[p[1]], c[p[2]]}; }

TEST(X06, ChannelPermutation) {
  Members members(4006);
  Row row("X06", "RGB of all materials, lights and emission permuted" + members.note(), "picture permuted bit for bit", "both");
  Equalities equalities;
  for (std::size_t i = 0; i < 4; ++i) {
    const Scene scene = random_room(members);
    const RenderSettings settings = room_settings(members.bits(), model_of(i));
    const auto plain = render_film(scene, settings, kSamples).plane("beauty");
    for (const std::array<int, 3>& p : {std::array{1, 2, 0}, std::array{2, 0, 1}, std::array{1, 0, 2},
                                        std::array{0, 2, 1}, std::array{2, 1, 0}}) {
      Scene other = scene;
      for (Material& m : other.materials) {
        m.diffuse = permuted(m.diffuse, p);
        m.specular = permuted(m.specular, p);
        m.emission = permuted(m.emission, p);
      }
      for (PointLight& light : other.point_lights) light.intensity = permuted(light.intensity, p);
      const auto now = render_film(other, settings, kSamples).plane("beauty");
      bool equal = true;
      for (std::size_t k = 0; k < now.size(); ++k) {
        equal = equal && now[k] == plain[3 * (k / 3) + static_cast<std::size_t>(p[k % 3])];
      }
      equalities.check(equal, "room " + std::to_string(i));
    }
  }
  equalities.report(row);
}

}  // namespace
}  // namespace raykiln::hard
