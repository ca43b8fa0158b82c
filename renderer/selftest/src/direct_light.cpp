#include "raykiln/selftest/direct_light.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raykiln/selftest/small_scene.hpp"

namespace raykiln::render::selftest {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNarrow = 1e-6;  ///< field of view that sees one point, rad

RenderSettings one_pixel(const LightModel& model) {
  RenderSettings settings;
  settings.width = settings.height = 1;
  settings.max_depth = 0;
  settings.light_model = model;
  settings.pixel_mode = PixelMode::kCentre;
  return settings;
}

double irradiated(const LightOverPlane& in, double distance) {
  return in.albedo / kPi * in.intensity * in.height /
         std::pow(in.height * in.height + distance * distance, 1.5);
}

SmallScene lit_plane(const LightOverPlane& in, double half) {
  SmallScene s;
  s.level_square(static_cast<float>(half), 0.0F, s.material(matte(static_cast<float>(in.albedo))));
  s.point_light({0, 0, in.height}, Rgb(static_cast<float>(in.intensity)));
  return s;
}

}  // namespace

Outcome light_over_plane(const LightOverPlane& in) {
  const double reach = in.height + in.distance;
  SmallScene s = lit_plane(in, 4.0 * reach);
  const Vec3d point(in.distance * std::cos(in.azimuth_rad), in.distance * std::sin(in.azimuth_rad), 0);
  s.look(point + reach * Vec3d(0.3, 0.2, 0.8), point, {0, 1, 0}, kNarrow);
  return exact_to(measure(s.scene(), one_pixel(in.model), 1), irradiated(in, in.distance), 1e-5);
}

Outcome light_over_square(const LightOverPlane& in, std::uint64_t samples) {
  const double side = in.distance;
  SmallScene s = lit_plane(in, 2.0 * side);
  s.look({0, 0, 2.0 * side}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(0.5));
  RenderSettings settings;
  settings.width = settings.height = 8;
  settings.max_depth = 0;
  settings.light_model = in.model;
  const double omega = 4.0 * std::atan(side * side / (in.height * std::sqrt(in.height * in.height +
                                                                             2.0 * side * side)));
  const double truth = in.albedo / kPi * in.intensity * omega / (4.0 * side * side);
  return statistically(measure(s.scene(), settings, samples), truth, 1e-6);
}

Outcome translucent_sheet(const LightOverPlane& in) {
  const double truth = 0.5 * in.albedo / kPi * in.intensity / (in.height * in.height);
  Outcome both{true, ""};
  for (const double side : {1.0, -1.0}) {
    SmallScene s;
    Material sheet = matte(static_cast<float>(in.albedo));
    sheet.transparent = 1.0F;
    s.level_square(static_cast<float>(4.0 * in.height), 0.0F, s.material(sheet));
    s.point_light({0, 0, in.height}, Rgb(static_cast<float>(in.intensity)));
    s.look(in.height * Vec3d(0.3, 0.2, 0.5 * side), {0, 0, 0}, {0, 1, 0}, kNarrow);
    const Outcome one = exact_to(measure(s.scene(), one_pixel(in.model), 1), truth, 1e-5);
    both.passed = both.passed && one.passed;
    both.measured += (side > 0.0 ? "lit side " : "; far side ") + one.measured;
  }
  return both;
}

Outcome umbra_of_square(const Umbra& in) {
  const double umbra = in.half * in.light / (in.light - in.occluder);
  const double view = 1.5 * umbra, eye = 0.9 * in.occluder;
  const LightOverPlane formula{.albedo = 0.8, .intensity = 10.0, .height = in.light};
  SmallScene s = lit_plane(formula, 4.0 * view);
  s.level_square(static_cast<float>(in.half), static_cast<float>(in.occluder),
                 s.material(matte(0.5F)));
  s.look({0, 0, eye}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(view / eye));
  RenderSettings settings = one_pixel(in.model);
  settings.width = settings.height = in.pixels;
  const Measured m = measure(s.scene(), settings, 1);
  const double pixel = 2.0 * view / in.pixels;
  int light_inside = 0, wrong_outside = 0, judged = 0;
  for (int i = 0; i < in.pixels * in.pixels; ++i) {
    const double x = (i % in.pixels + 0.5) * pixel - view, y = view - (i / in.pixels + 0.5) * pixel;
    const double edge = std::max(std::abs(x), std::abs(y)) - umbra;
    if (std::abs(edge) <= pixel) continue;
    ++judged;
    const double value = m.pixels[static_cast<std::size_t>(i)];
    const double truth = irradiated(formula, std::hypot(x, y));
    if (edge < 0.0) light_inside += value != 0.0 ? 1 : 0;
    if (edge > 0.0) wrong_outside += std::abs(value - truth) > 1e-5 * truth ? 1 : 0;
  }
  return {light_inside == 0 && wrong_outside == 0 && judged > 0 && m.stats.non_finite == 0,
          std::to_string(light_inside) + " lit inside, " + std::to_string(wrong_outside) +
              " wrong outside, of " + std::to_string(judged) + " pixels; half-side " + text(umbra)};
}

}  // namespace raykiln::render::selftest
