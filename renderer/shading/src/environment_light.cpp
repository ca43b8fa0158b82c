#include "raykiln/shading/environment_light.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "raykiln/sampling/warp.hpp"

namespace raykiln::render {
namespace {

double largest_channel(const Rgb& c) {
  return static_cast<double>(std::max({c.x, c.y, c.z, 0.0F}));
}

/// cos(a) - cos(b) without cancellation.
double cosine_difference(double a, double b) {
  return 2.0 * std::sin(0.5 * (a + b)) * std::sin(0.5 * (b - a));
}

struct Drawn {
  std::size_t index = 0;
  double rest = 0.0;  ///< uniform in [0, 1): what the choice left of the number
};

/// Index by cumulative sums. One of weight 0 is never drawn: not in front of a step, and at the end
/// of the sums the first that reaches them is taken.
Drawn draw(std::span<const double> sums, double u) {
  const double target = u * sums.back();
  auto at = std::upper_bound(sums.begin(), sums.end(), target);
  if (at == sums.end()) at = std::lower_bound(sums.begin(), sums.end(), sums.back());
  const double before = at == sums.begin() ? 0.0 : *(at - 1);
  const double rest = (target - before) / (*at - before);
  return {static_cast<std::size_t>(at - sums.begin()), std::clamp(rest, 0.0, 1.0 - 0x1p-53)};
}

}  // namespace

EnvironmentLight::EnvironmentLight(std::shared_ptr<const EnvironmentMap> map)
    : map_(std::move(map)),
      cos_rotation_(std::cos(map_->rotation_rad)),
      sin_rotation_(std::sin(map_->rotation_rad)) {
  const auto width = static_cast<std::size_t>(map_->width);
  const auto height = static_cast<std::size_t>(map_->height);
  const double step = kPi / map_->height;
  columns_.resize(width * height);
  rows_.resize(height);
  double total = 0.0;
  for (std::size_t row = 0; row < height; ++row) {
    double sum = 0.0;
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      sum += largest_channel(map_->texel(i));
      columns_[i] = sum;
    }
    const auto top = static_cast<double>(row) * step;
    const double texel_sr = 2.0 * kPi / map_->width * cosine_difference(top, top + step);
    total += sum * texel_sr;
    rows_[row] = total;
  }
}

EnvironmentLight::Seen EnvironmentLight::texel(std::size_t row, std::size_t column) const {
  const Rgb radiance = map_->texel(row * static_cast<std::size_t>(map_->width) + column);
  return {Rgbd(radiance), shines() ? largest_channel(radiance) / total() : 0.0};
}

// Within a texel the cosine of the polar angle and the azimuth are uniform. x = 1 - cos gives the
// sine without cancellation near the zenith.
EnvironmentSample EnvironmentLight::sample(double u, double v) const {
  const auto width = static_cast<std::size_t>(map_->width);
  const Drawn row = draw(rows_, u);
  const Drawn column = draw(std::span(columns_).subspan(row.index * width, width), v);
  const double step = kPi / map_->height;
  const auto top = static_cast<double>(row.index) * step;
  const double half_sine = std::sin(0.5 * top);
  const double x =
      std::min(2.0 * half_sine * half_sine + row.rest * cosine_difference(top, top + step), 2.0);
  const double sine = std::sqrt(x * (2.0 - x));
  const double azimuth =
      2.0 * kPi * ((static_cast<double>(column.index) + column.rest) / map_->width - 0.5);
  const double right = sine * std::sin(azimuth), back = -sine * std::cos(azimuth);
  EnvironmentSample sample;
  sample.wi = {cos_rotation_ * right + sin_rotation_ * back, 1.0 - x,
               cos_rotation_ * back - sin_rotation_ * right};
  const Seen seen = texel(row.index, column.index);
  sample.radiance = seen.radiance;
  sample.pdf = seen.pdf;
  return sample;
}

EnvironmentSample EnvironmentLight::sample(const VertexKey& vertex) const {
  return sample(uniform(vertex, Dimension::kEnvironmentU),
                uniform(vertex, Dimension::kEnvironmentV));
}

EnvironmentLight::Seen EnvironmentLight::towards(const Vec3d& d) const {
  const double right = cos_rotation_ * d.x - sin_rotation_ * d.z;
  const double back = cos_rotation_ * d.z + sin_rotation_ * d.x;
  const double polar = std::atan2(std::sqrt(right * right + back * back), d.y);
  const double turn = 0.5 + std::atan2(right, -back) / (2.0 * kPi);
  const auto cell = [](double share, int cells) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(share * cells), 0, cells - 1));
  };
  return texel(cell(polar / kPi, map_->height), cell(turn, map_->width));
}

}  // namespace raykiln::render
