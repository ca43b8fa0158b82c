#include "raykiln/shading/texture_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "raykiln/math/srgb.hpp"
#include "raykiln/shading/texture_lookup.hpp"

namespace raykiln::render {
namespace {

int half(int size) { return std::max(size / 2, 1); }

/// What of a row of `size` texels one of half(size) covers: up to three of them, and how much of each.
struct Cover {
  int first = 0, count = 0;
  std::array<double, 3> share{};
};
Cover cover(int i, int size) {
  const double width = static_cast<double>(size) / half(size);
  const double from = i * width, to = from + width;
  Cover c;
  c.first = static_cast<int>(from);
  for (int k = c.first; k < size && c.count < 3; ++k) {
    const double share = std::min(to, k + 1.0) - std::max(from, static_cast<double>(k));
    if (!(share > 1e-9)) break;
    c.share[static_cast<std::size_t>(c.count++)] = share / width;
  }
  return c;
}

/// Of a byte: its linear value, or what it is of 255.
using ByteValues = std::array<double, 256>;
const ByteValues& byte_values(bool colours) {
  static const auto tables = [] {
    std::array<ByteValues, 2> made{};
    for (std::size_t i = 0; i < made[0].size(); ++i) {
      made[0][i] = static_cast<double>(i) / 255.0;
      made[1][i] = linear_of_srgb(made[0][i]);
    }
    return made;
  }();
  return tables[colours ? 1 : 0];
}

/// Linear values of the texels, or their bytes over 255.
class Values {
 public:
  Values(const TextureImage& image, bool colours) : image_(image), of_byte_(byte_values(colours)) {}
  [[nodiscard]] double at(std::size_t i) const {
    return image_.srgb8.empty() ? static_cast<double>(image_.linear[i]) : of_byte_[image_.srgb8[i]];
  }

 private:
  const TextureImage& image_;
  const ByteValues& of_byte_;
};

double mean(const TextureImage& image, const Values& values, const Cover& x, const Cover& y, int channel) {
  double sum = 0.0;
  for (int j = 0; j < y.count; ++j) {
    for (int i = 0; i < x.count; ++i) {
      const auto texel = static_cast<std::size_t>(y.first + j) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x.first + i);
      const std::size_t at = texel * static_cast<std::size_t>(image.channels) + static_cast<std::size_t>(channel);
      sum += y.share[static_cast<std::size_t>(j)] * x.share[static_cast<std::size_t>(i)] * values.at(at);
    }
  }
  return sum;
}

std::size_t bytes_below(const TextureImage& image) {
  const std::size_t value = image.srgb8.empty() ? sizeof(float) : 1;
  std::size_t total = 0;
  for (int w = image.width, h = image.height; w > 1 || h > 1;) {
    w = half(w);
    h = half(h);
    total += static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(image.channels) * value +
             sizeof(TextureImage);
  }
  return total;
}

}  // namespace

TextureImage halved(const TextureImage& image, bool data) { return *halved(image, data, {}); }

std::optional<TextureImage> halved(const TextureImage& image, bool data, const std::stop_token& stop) {
  const bool bytes = !image.srgb8.empty(), colours = !data && image.channels == 3;
  const Values values(image, colours);
  TextureImage smaller{.name = {}, .width = half(image.width), .height = half(image.height), .srgb8 = {}, .linear = {},
                       .channels = image.channels};
  const std::size_t values_in_all = static_cast<std::size_t>(smaller.width) * static_cast<std::size_t>(smaller.height) *
                                    static_cast<std::size_t>(image.channels);
  if (bytes) {
    smaller.srgb8.reserve(values_in_all);
  } else {
    smaller.linear.reserve(values_in_all);
  }
  for (int y = 0; y < smaller.height; ++y) {
    if (stop.stop_requested()) return std::nullopt;
    const Cover rows = cover(y, image.height);
    for (int x = 0; x < smaller.width; ++x) {
      const Cover columns = cover(x, image.width);
      for (int c = 0; c < image.channels; ++c) {
        const double value = mean(image, values, columns, rows, c);
        if (bytes) {
          const double display = colours ? srgb_of_linear(value) : value;
          smaller.srgb8.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(255.0 * display), 0L, 255L)));
        } else {
          smaller.linear.push_back(static_cast<float>(value));
        }
      }
    }
  }
  return smaller;
}

TexturePyramids::TexturePyramids(const SurfaceTextures* textures) : textures_(textures) {
  if (textures_ == nullptr) return;
  on_demand_ = std::make_unique<OnDemand>();
  std::vector<Pyramid>& pyramids = on_demand_->pyramids;
  pyramids.resize(2 * textures_->images.size());
  for (const MaterialTextures& used : textures_->materials) {
    for (const TextureUse* use : {&used.base, &used.roughness, &used.normal, &used.through, &used.through_colour}) {
      if (!use->used() || pyramids[index_of(*use)].wanted) continue;
      pyramids[index_of(*use)].wanted = true;
      bytes_ += bytes_below(textures_->images[use->image]);
    }
  }
}

bool TexturePyramids::go_on(const TextureImage& image, bool data, std::vector<TextureImage>& copies,
                            const std::stop_token& stop) {
  while (true) {
    const TextureImage& last = copies.empty() ? image : copies.back();
    if (last.width <= 1 && last.height <= 1) return true;
    auto next = halved(last, data, stop);
    if (!next) return false;
    copies.push_back(std::move(*next));
  }
}

bool TexturePyramids::make(const std::stop_token& stop) const {
  if (on_demand_ == nullptr) return true;
  return on_demand_->made.once(stop, [&] {
    std::vector<Pyramid>& pyramids = on_demand_->pyramids;
    for (std::size_t i = 0; i < pyramids.size(); ++i) {
      if (!pyramids[i].wanted) continue;
      if (!go_on(textures_->images[i / 2], i % 2 != 0, pyramids[i].copies, stop)) return false;
    }
    return true;
  });
}

Rgbd TexturePyramids::value(const TextureUse& use, double u, double v, double level) const {
  const TextureImage& image = textures_->images[use.image];
  const std::vector<TextureImage>& copies = on_demand_->pyramids[index_of(use)].copies;
  if (!(level > 0.0) || copies.empty()) return texture_value(image, use, u, v);
  const auto read = [&](std::size_t k) { return texture_value(k == 0 ? image : copies[k - 1], use, u, v); };
  const std::size_t last = copies.size();
  if (level >= static_cast<double>(last)) return read(last);
  const double finer = std::floor(level), share = level - finer;
  const auto k = static_cast<std::size_t>(finer);
  return (1.0 - share) * read(k) + share * read(k + 1);
}

}  // namespace raykiln::render
