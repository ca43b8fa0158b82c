// What does choosing emitters from a tree gain over choosing by power alone, at equal time?
// Usage: bench_many_lights [SAMPLES] [SEEDS] [SIDE_PX] [SCENE]   JSON, a scene after the other
// relMSE is the scatter of pictures between seeds; renders with either choice take turns, and only their
// processor seconds count. That both have the same limit is checked meanwhile (exit code 3 if not).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include "bench/render/picture_scatter.hpp"
#include "support/scene_pieces.hpp"

namespace {

using namespace raykiln::render;
using support::diffuse_material;
using support::SceneBuilder;

double number(std::uint64_t i, std::uint64_t what) {
  return uniform(vertex_key(path_key(4711, i, what), 0, 0), Dimension::kLightU);
}

/// A square floor with boxes up to 1 m high, seen from one corner at 1.4 m: all rays of the camera go down.
SceneBuilder hall(float side) {
  SceneBuilder b;
  const auto grey = b.material(diffuse_material(Rgb(0.6F)));
  b.quad({Vec3f(0, 0, 0), {side, 0, 0}, {side, side, 0}, {0, side, 0}}, grey);
  for (std::uint64_t i = 0; i < 40; ++i) {
    const Vec3f at(Vec3d(1.0 + 6.0 * number(i, 0), 1.0 + 6.0 * number(i, 1), 0.0));
    b.box(at, at + Vec3f(0.3F, 0.3F, 0.2F + 0.8F * static_cast<float>(number(i, 2))), grey);
  }
  b.camera({0.5, 0.5, 1.4}, {3, 3, 0}, {0, 0, 1}, 0.7);
  return b;
}

/// A square of this side 1.5 to 3 m over the floor, turned at random: above what the camera sees.
void lamp(SceneBuilder& b, std::uint64_t i, float hall_side, double side, std::uint32_t material) {
  const double across = static_cast<double>(hall_side);
  const Vec3d middle(across * number(i, 10), across * number(i, 11), 1.5 + 1.5 * number(i, 12));
  const Vec3d n = normalize(Vec3d(number(i, 13), number(i, 14), number(i, 15)) - 0.5);
  const Vec3d u = 0.5 * side * normalize(cross(n, Vec3d(0.3, 0.5, 0.81)));
  const Vec3d v = cross(n, u);
  b.quad({Vec3f(middle - u - v), Vec3f(middle + u - v), Vec3f(middle + u + v), Vec3f(middle - u + v)}, material);
}

/// So many lamps, whose radiances differ 1000 and powers 19 times.
SceneBuilder hall_of(float side, std::uint64_t lamps) {
  SceneBuilder b = hall(side);
  std::uint32_t material[8];
  const auto radiance = [](unsigned k) { return std::pow(10.0, k * 3.0 / 7.0); };
  for (unsigned k = 0; k < 8; ++k) {
    material[k] = b.material(diffuse_material(Rgb(0.0F), Rgb(static_cast<float>(radiance(k)))));
  }
  for (std::uint64_t i = 0; i < lamps; ++i) {
    const auto k = static_cast<unsigned>(8.0 * number(i, 20));
    const double power = (0.1 + 1.8 * number(i, 21)) * 8.0 / static_cast<double>(lamps);
    lamp(b, i, side, std::sqrt(power / radiance(k)), material[k]);
  }
  return b;
}
template <int kSide, std::uint64_t kLamps>
SceneBuilder lamps() {
  return hall_of(static_cast<float>(kSide), kLamps);
}

/// Dim walls of light about 500 sparks, which have a third of the power.
SceneBuilder sparks_between_panels() {
  SceneBuilder b = hall(10.0F);
  const auto panel = b.material(diffuse_material(Rgb(0.0F), Rgb(0.05F)));
  const auto spark = b.material(diffuse_material(Rgb(0.0F), Rgb(5e4F)));
  b.quad({Vec3f(0, 10, 1.4F), {10, 10, 1.4F}, {10, 10, 6}, {0, 10, 6}}, panel);
  b.quad({Vec3f(10, 0, 1.4F), {10, 10, 1.4F}, {10, 10, 6}, {10, 0, 6}}, panel);
  for (std::uint64_t i = 0; i < 500; ++i) lamp(b, i, 10.0F, 3e-4, spark);
  return b;
}

/// A ball of light of 20000 triangles that shine alike; half of them are turned away.
SceneBuilder glowing_ball() {
  SceneBuilder b = hall(10.0F);
  const auto glow = b.material(diffuse_material(Rgb(0.0F), Rgb(5.0F)));
  constexpr int kRings = 100;
  const auto at = [](int i, int j) {
    const double t = 3.14159265358979 * i / kRings, p = 2.0 * 3.14159265358979 * j / kRings;
    return Vec3f(Vec3d(4, 4, 2.5) + Vec3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)));
  };
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < kRings; ++j) b.quad({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, glow);
  }
  return b;
}

/// A closed room with so many square lamps in its ceiling: light comes by way of many surfaces.
template <int kLamps>
SceneBuilder room() {
  SceneBuilder b;
  b.box(Vec3f(-1.0F), Vec3f(1.0F), b.material(diffuse_material(Rgb(0.7F))), true);
  const auto white = b.material(diffuse_material(Rgb(0.7F)));
  b.box({-0.6F, -1.0F, -0.6F}, {-0.1F, 0.1F, -0.1F}, white);
  b.box({0.2F, -1.0F, -0.3F}, {0.7F, -0.4F, 0.3F}, white);
  const auto glow = b.material(diffuse_material(Rgb(0.0F), Rgb(10.0F)));
  for (int i = 0; i < kLamps; ++i) {
    const Vec3f at(-0.75F + 1.4F * static_cast<float>(i % 4) / 3.0F, 0.98F, -0.6F + 0.5F * static_cast<float>(i / 4));
    b.quad({at, at + Vec3f(0.2F, 0, 0), at + Vec3f(0.2F, 0, 0.2F), at + Vec3f(0, 0, 0.2F)}, glow);
  }
  b.camera({0, 0, 0.95}, {0, -0.3, -1}, {0, 1, 0}, 1.1);
  return b;
}

struct BenchScene {
  const char* name;
  SceneBuilder (*scene)();
};
constexpr BenchScene kScenes[] = {{"room_1", room<1>},
                                  {"room_4", room<4>},
                                  {"room_8", room<8>},
                                  {"hall_10m_1", lamps<10, 1>},
                                  {"hall_10m_2", lamps<10, 2>},
                                  {"hall_10m_4", lamps<10, 4>},
                                  {"hall_10m_8", lamps<10, 8>},
                                  {"hall_10m_16", lamps<10, 16>},
                                  {"hall_10m_500", lamps<10, 500>},
                                  {"hall_10m_50000", lamps<10, 50000>},
                                  {"hall_100m_500", lamps<100, 500>},
                                  {"hall_100m_50000", lamps<100, 50000>},
                                  {"sparks_between_panels", sparks_between_panels},
                                  {"glowing_ball", glowing_ball}};

struct Choice {
  explicit Choice(std::size_t values) : scatter(values) {}
  bench::Scatter scatter;
  double seconds = 0.0;
};

void render(const PreparedScene& scene, const RenderSettings& settings, std::uint64_t samples, Choice& choice) {
  Film film = make_film(settings);
  const auto blocks = blocks_for(samples);
  const std::clock_t start = std::clock();
  merge(film, render_tile(scene, settings, {0, 0, settings.width, settings.height}, blocks, {}));
  choice.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  choice.scatter.add(bench::means_of(film));
}

/// The first render that asks for the tree builds it, once a scene: its seconds are told apart.
double build_tree(const PreparedScene& scene, RenderSettings settings) {
  settings.width = settings.height = 1;
  settings.emitter_choice = EmitterChoice::kTree;
  const std::clock_t start = std::clock();
  (void)render_tile(scene, settings, {0, 0, 1, 1}, blocks_for(1), {});
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

bool compare(const BenchScene& s, int side, std::uint64_t samples, std::uint64_t seeds) {
  const SceneBuilder built = s.scene();
  std::size_t emitters = 0;
  for (const std::uint32_t m : built.scene().mesh.material_ids) emitters += built.scene().materials[m].emission.x > 0.0F;
  const auto scene = built.prepare();
  RenderSettings settings;
  settings.max_depth = 4;
  const double tree_seconds = build_tree(*scene, settings);
  settings.width = settings.height = side;
  const std::size_t values = 3 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  Choice power(values), tree(values);
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    settings.seed = seed;
    settings.emitter_choice = EmitterChoice::kPower;
    render(*scene, settings, samples, power);
    settings.seed = seed + seeds;
    settings.emitter_choice = EmitterChoice::kTree;
    render(*scene, settings, samples, tree);
  }
  const double apart = std::abs(power.scatter.mean() - tree.scatter.mean()) /
                       std::sqrt(power.scatter.variance() + tree.scatter.variance());
  const double p = power.scatter.rel_mse(), t = tree.scatter.rel_mse();
  std::printf("  {\"scene\": \"%s\", \"emitting_triangles\": %zu, \"tree_seconds\": %.3f,\n"
              "   \"rel_mse_power\": %.4e, \"rel_mse_tree\": %.4e, \"seconds_power\": %.3f, \"seconds_tree\": %.3f,\n"
              "   \"gain_at_equal_samples\": %.3f, \"gain_at_equal_time\": %.3f, \"means_apart_in_standard_errors\": %.2f},\n",
              s.name, emitters, tree_seconds, p, t, power.seconds, tree.seconds, p / t, p * power.seconds / (t * tree.seconds),
              apart);
  std::fflush(stdout);
  return apart < 5.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::atoi(argv[1]) <= 0) {
    std::puts("usage: bench_many_lights [SAMPLES] [SEEDS] [SIDE_PX] [SCENE]\n"
              "Error and processor seconds with emitters chosen by power and from a tree; JSON. Defaults: 16 8 48.");
    return std::string_view(argv[1]) == "--help" ? 0 : 2;
  }
  const auto samples = static_cast<std::uint64_t>(argc > 1 ? std::atoll(argv[1]) : 16);
  const auto seeds = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 8);
  const int side = argc > 3 ? std::atoi(argv[3]) : 48;
  bool ok = true;
  std::printf("{\"side_px\": %d, \"samples\": %llu, \"seeds\": %llu, \"threads\": 1, \"scenes\": [\n", side,
              static_cast<unsigned long long>(samples), static_cast<unsigned long long>(seeds));
  for (const BenchScene& s : kScenes) {
    if (argc > 4 && s.name != std::string_view(argv[4])) continue;
    ok = compare(s, side, samples, seeds) && ok;
  }
  std::printf("  {}]}\n");
  return ok ? 0 : 3;
}
