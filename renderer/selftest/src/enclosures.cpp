#include "raykiln/selftest/enclosures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

constexpr double kPi = std::numbers::pi;

RenderSettings settings_of(const LightModel& model, int side) {
  RenderSettings settings;
  settings.width = settings.height = side;
  settings.light_model = model;
  settings.max_depth = 128;
  return settings;
}

/// Reflections after which less than 1e-8 of the light is left between walls of this albedo.
int enough_reflections(double albedo) {
  return std::min(128, static_cast<int>(std::ceil(std::log(1e-8) / std::log(albedo))));
}

/// Without roulette a path in a closed room takes all reflections: as many rays, fewer paths.
std::uint64_t affordable(const LightModel& model, std::uint64_t samples) {
  return model.roulette ? samples : (samples + 15) / 16;
}

SmallScene room(double albedo) {
  SmallScene s;
  const auto emission = static_cast<float>(1.0 - albedo);
  s.box(Vec3f(-1.0F), Vec3f(1.0F), s.material(matte(1.0F - emission, emission)), true);
  s.look({0.5, 0.6, 0.9}, {-0.1, 0.0, 0.0}, {0, 1, 0}, 1.2);
  return s;
}

Material guest_material(FurnaceGuest guest) {
  Material m = guest == FurnaceGuest::kLeaf ? matte(1.0F) : clear_glass(1.5F);
  m.transparent = guest == FurnaceGuest::kMirror ? 0.0F : 1.0F;
  return m;
}

/// Triangles of a sphere about the origin, normals inwards; material(z) is asked at the middle of a
/// band. Returns the area of those whose material is `counted`, and of all.
struct SphereAreas {
  double counted = 0.0, all = 0.0;
};
template <typename MaterialAt>
SphereAreas add_sphere(SmallScene& s, MaterialAt material_at, std::uint32_t counted) {
  constexpr int kBands = 64, kSectors = 128;
  SphereAreas areas;
  const auto at = [&](int i, int j) {
    const double theta = kPi * i / kBands, phi = 2.0 * kPi * (j % kSectors) / kSectors;
    const double sine = i == 0 || i == kBands ? 0.0 : std::sin(theta);
    return Vec3f(Vec3d(sine * std::cos(phi), sine * std::sin(phi), std::cos(theta)));
  };
  const auto add = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c, std::uint32_t material) {
    const double area = 0.5 * length(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)));
    if (!(area > 0.0)) return;
    s.triangle(a, c, b, material);
    areas.all += area;
    areas.counted += material == counted ? area : 0.0;
  };
  for (int i = 0; i < kBands; ++i) {
    const std::uint32_t material = material_at(std::cos(kPi * (i + 0.5) / kBands));
    for (int j = 0; j < kSectors; ++j) {
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1), material);
      add(at(i, j), at(i + 1, j + 1), at(i, j + 1), material);
    }
  }
  return areas;
}

}  // namespace

Outcome furnace(double albedo, FurnaceGuest guest, const LightModel& model, std::uint64_t samples) {
  SmallScene s = room(albedo);
  if (guest != FurnaceGuest::kNone) {
    s.box({-0.5F, -0.4F, -0.6F}, {0.1F, 0.3F, 0.2F}, s.material(guest_material(guest)));
  }
  RenderSettings settings = settings_of(model, 32);
  // Inside a guest a path goes on without loss.
  if (guest == FurnaceGuest::kNone) settings.max_depth = enough_reflections(albedo);
  const Measured m = measure(s.scene(), settings, affordable(model, samples));
  return statistically(m, 1.0, 1e-6);
}

Outcome truncated_furnace(double albedo, int depth, const LightModel& model,
                          std::uint64_t samples) {
  RenderSettings settings = settings_of(model, 16);
  settings.max_depth = depth;
  settings.emitter_sampling = false;
  const Measured m = measure(room(albedo).scene(), settings, samples);
  const double truth = 1.0 - std::pow(albedo, depth + 1);
  const bool noiseless =
      model.diffuse_sampling == DiffuseSampling::kCosine && !model.roulette;
  return noiseless ? exact_to(m, truth, 1e-5) : statistically(m, truth, 1e-6);
}

Outcome sphere_with_light(double albedo, const LightModel& model, std::uint64_t samples) {
  SmallScene s;
  const auto wall = s.material(matte(static_cast<float>(albedo)));
  add_sphere(s, [&](double) { return wall; }, wall);
  s.point_light(Vec3f(0.0F), Rgb(static_cast<float>(kPi)));
  s.look({0.3, 0.1, 0.2}, {-1, 0.3, -0.2}, {0, 0, 1}, 1.0);
  RenderSettings settings = settings_of(model, 16);
  settings.max_depth = enough_reflections(albedo);
  const Measured m = measure(s.scene(), settings, affordable(model, samples));
  return statistically(m, albedo / (1.0 - albedo), 2e-3);
}

Outcome sphere_with_cap(double albedo, bool black_cap, const LightModel& model,
                        std::uint64_t samples) {
  SmallScene s;
  const auto wall = s.material(matte(static_cast<float>(albedo)));
  const auto cap = s.material(matte(black_cap ? 0.0F : static_cast<float>(albedo), 2.0F));
  const SphereAreas areas = add_sphere(s, [&](double z) { return z > 0.8 ? cap : wall; }, cap);
  s.look({0.1, 0.1, 0.2}, {0.2, 0.3, -1.0}, {0, 1, 0}, 0.6);  // sees the wall alone
  RenderSettings settings = settings_of(model, 16);
  settings.max_depth = enough_reflections(albedo);
  const Measured m = measure(s.scene(), settings, affordable(model, samples));
  const double f = areas.counted / areas.all;
  const double truth = albedo * f * 2.0 / (1.0 - albedo * (black_cap ? 1.0 - f : 1.0));
  return statistically(m, truth, 3e-3);
}

}  // namespace raykiln::render::selftest
