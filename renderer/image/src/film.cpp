#include "raykiln/image/film.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace raykiln::render {
namespace {

std::uint32_t as_count(double value) { return static_cast<std::uint32_t>(value); }

/// Every plane is there with as many values as the tile's pixels need.
bool planes_fit(const PlaneSet& set, std::size_t pixels) {
  const auto specs = block_planes();
  return std::equal(set.planes.begin(), set.planes.end(), specs.begin(), specs.end(),
                    [pixels](const std::vector<double>& plane, const PlaneSpec& spec) {
                      return plane.size() == pixels * static_cast<std::size_t>(spec.channels);
                    });
}

double sum_luminance(const std::array<double, 3>& c) { return luminance({c[0], c[1], c[2]}); }

}  // namespace

Film::Film(int width, int height, SampleRelation relation)
    : width_(width),
      height_(height),
      relation_(relation),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

std::uint64_t PixelSums::samples() const {
  return std::accumulate(luminance_count.begin(), luminance_count.end(), std::uint64_t{0});
}

std::size_t Film::bytes_per_pixel() { return sizeof(PixelSums) + sizeof(Tail); }

Film::Tail Film::read_block(const BlockResult& result, std::size_t pixel) {
  const auto& planes = result.planes.planes;
  const auto at = [&](BlockPlane::Index plane) { return planes[plane][pixel]; };
  Tail tail;
  std::copy_n(&planes[BlockPlane::kBeauty][3 * pixel], 3, tail.beauty.begin());
  tail.luminance_moment = at(BlockPlane::kLuminanceMoment);
  std::copy_n(&planes[BlockPlane::kMoment][3 * pixel], 3, tail.moment.begin());
  tail.largest = at(BlockPlane::kLargest);
  tail.counts = {as_count(at(BlockPlane::kNan)), as_count(at(BlockPlane::kInf)), as_count(at(BlockPlane::kNegative)),
                 as_count(at(BlockPlane::kTruncated))};
  tail.samples = as_count(at(BlockPlane::kSamples));
  tail.replicate = static_cast<std::uint32_t>(replicate_of(result.block.index));
  return tail;
}

// Chan, Golub & LeVeque 1979: M = M_a + M_b + (mean_b - mean_a)^2 n_a n_b / (n_a + n_b).
void Film::fold_pixel(PixelSums& into, const Tail& from) {
  const double n_a = static_cast<double>(into.samples());
  const double n_b = from.samples;
  const double from_sum = sum_luminance(from.beauty);
  const bool apart = n_a > 0.0 && n_b > 0.0;
  const double weight = apart ? n_a * n_b / (n_a + n_b) : 0.0;
  into.luminance_moment += from.luminance_moment;
  if (apart) {
    const double difference = from_sum / n_b - sum_luminance(into.beauty) / n_a;
    into.luminance_moment += difference * difference * weight;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    into.moment[c] += from.moment[c];
    if (apart) {
      const double difference = from.beauty[c] / n_b - into.beauty[c] / n_a;
      into.moment[c] += difference * difference * weight;
    }
    into.beauty[c] += from.beauty[c];
  }
  into.largest = std::max(into.largest, from.largest);
  into.counts.nan += from.counts.nan;
  into.counts.inf += from.counts.inf;
  into.counts.negative += from.counts.negative;
  into.counts.truncated += from.counts.truncated;
  into.luminance_sum[from.replicate] += from_sum;
  into.luminance_count[from.replicate] += from.samples;
}

void Film::fold(const PixelRect& tile, const BlockResult& result) {
  const bool inside = 0 <= tile.x0 && tile.x0 <= tile.x1 && tile.x1 <= width_ && 0 <= tile.y0 &&
                      tile.y0 <= tile.y1 && tile.y1 <= height_;
  if (!inside || !planes_fit(result.planes, tile.pixels())) {
    throw std::invalid_argument("the block does not fit the film");
  }
  if (!result.block.complete && tails_.empty()) tails_.resize(pixels_.size());
  std::size_t source = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    std::size_t target = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                         static_cast<std::size_t>(tile.x0);
    for (int x = tile.x0; x < tile.x1; ++x, ++source, ++target) {
      const Tail read = read_block(result, source);
      if (result.block.complete) fold_pixel(pixels_[target], read);
      if (!tails_.empty()) tails_[target] = result.block.complete ? Tail{} : read;
    }
  }
}

PixelSums Film::pixel(std::size_t index) const {
  PixelSums value = pixels_[index];
  if (!tails_.empty()) fold_pixel(value, tails_[index]);
  return value;
}

Image Film::resolve() const {
  Image image{.width = width_, .height = height_, .rgb = std::vector<float>(3 * pixels_.size())};
  resolve({0, 0, width_, height_}, image);
  return image;
}

void Film::resolve(const PixelRect& part, Image& into) const {
  for (int y = part.y0; y < part.y1; ++y) {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = part.x0; x < part.x1; ++x) {
      const auto i = row + static_cast<std::size_t>(x);
      const PixelSums sums = pixel(i);
      const std::uint64_t n = sums.samples();
      if (n == 0) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        into.rgb[3 * i + c] = static_cast<float>(sums.beauty[c] / static_cast<double>(n));
      }
    }
  }
}

std::vector<double> Film::plane(std::string_view name) const {
  std::vector<double> values;
  const auto gather = [&](auto&& append) {
    for (std::size_t i = 0; i < pixels_.size(); ++i) append(pixel(i));
    return values;
  };
  const auto push_all = [&](const auto& list) {
    for (const auto value : list) values.push_back(static_cast<double>(value));
  };
  if (name == "beauty") return gather([&](const PixelSums& p) { push_all(p.beauty); });
  if (name == "samples") {
    return gather([&](const PixelSums& p) {
      values.push_back(static_cast<double>(p.samples()));
    });
  }
  if (name == "luminance_count") return gather([&](const PixelSums& p) { push_all(p.luminance_count); });
  if (name == "luminance_sum") return gather([&](const PixelSums& p) { push_all(p.luminance_sum); });
  if (name == "luminance_moment") return gather([&](const PixelSums& p) { values.push_back(p.luminance_moment); });
  if (name == "moment") return gather([&](const PixelSums& p) { push_all(p.moment); });
  if (name == "largest") return gather([&](const PixelSums& p) { values.push_back(p.largest); });
  if (name == "nan") return gather([&](const PixelSums& p) { values.push_back(p.counts.nan); });
  if (name == "inf") return gather([&](const PixelSums& p) { values.push_back(p.counts.inf); });
  if (name == "negative") return gather([&](const PixelSums& p) { values.push_back(p.counts.negative); });
  if (name == "truncated") {
    return gather([&](const PixelSums& p) { values.push_back(p.counts.truncated); });
  }
  return values;
}

}  // namespace raykiln::render
