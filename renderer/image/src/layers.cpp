#include "raykiln/image/layers.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace raykiln::render {
namespace {

constexpr std::array<LayerSpec, kLayers> kSpecs{{
    {"albedo", 3, {"albedo.R", "albedo.G", "albedo.B"}},
    {"normal", 3, {"N.X", "N.Y", "N.Z"}},
    {"depth", 1, {"Z", "", ""}},
    {"object_id", 1, {"object_id", "", ""}},
    {"material_id", 1, {"material_id", "", ""}},
    {"emission", 3, {"emission.R", "emission.G", "emission.B"}},
    {"direct", 3, {"direct.R", "direct.G", "direct.B"}},
    {"indirect", 3, {"indirect.R", "indirect.G", "indirect.B"}},
}};

Layer layer_at(std::size_t index) { return static_cast<Layer>(index); }

/// Depth has the number of samples that met something beside its sum.
std::size_t sums_of(Layer layer) { return layer == Layer::kDepth ? 2 : spec(layer).channels; }

/// Where the sums of `layer` begin among those of a pixel.
std::size_t offset_of(const LayerSet& set, Layer layer) {
  std::size_t offset = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(layer); ++i) {
    if (set.contains(layer_at(i))) offset += sums_of(layer_at(i));
  }
  return offset;
}

bool is_id(Layer layer) { return layer == Layer::kObjectId || layer == Layer::kMaterialId; }

std::array<double, 3> values_of(const LayerSample& s, Layer layer) {
  switch (layer) {
    case Layer::kAlbedo: return {s.albedo.x, s.albedo.y, s.albedo.z};
    case Layer::kNormal: return {s.normal.x, s.normal.y, s.normal.z};
    case Layer::kDepth: return {s.met ? s.depth : 0.0, s.met ? 1.0 : 0.0, 0.0};
    case Layer::kObjectId: return {static_cast<double>(s.object), 0.0, 0.0};
    case Layer::kMaterialId: return {static_cast<double>(s.material), 0.0, 0.0};
    case Layer::kEmission: return {s.emission.x, s.emission.y, s.emission.z};
    case Layer::kDirect: return {s.direct.x, s.direct.y, s.direct.z};
    case Layer::kIndirect: break;
  }
  return {s.indirect.x, s.indirect.y, s.indirect.z};
}

}  // namespace

const LayerSpec& spec(Layer layer) { return kSpecs[static_cast<std::size_t>(layer)]; }

std::optional<Layer> layer_named(std::string_view name) {
  for (std::size_t i = 0; i < kLayers; ++i) {
    if (kSpecs[i].name == name) return layer_at(i);
  }
  return std::nullopt;
}

std::vector<Layer> layers_in(const LayerSet& set) {
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < kLayers; ++i) {
    if (set.contains(layer_at(i))) layers.push_back(layer_at(i));
  }
  return layers;
}

std::optional<LayerSet> layer_set_of(std::string_view text) {
  LayerSet set;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    const auto layer = layer_named(text.substr(0, comma));
    const bool ends_in_comma = comma != std::string_view::npos && comma + 1 == text.size();
    if (!layer || set.contains(*layer) || ends_in_comma) return std::nullopt;
    set.insert(*layer);
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  }
  return set;
}

std::string layer_set_text(const LayerSet& set) {
  std::string text;
  for (const Layer layer : layers_in(set)) text.append(text.empty() ? "" : ",").append(spec(layer).name);
  return text;
}

std::string all_layer_names() {
  std::string text;
  for (const LayerSpec& layer : kSpecs) text.append(text.empty() ? "" : ", ").append(layer.name);
  return text;
}

std::size_t sums_of(const LayerSet& set) {
  std::size_t sums = 0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    if (set.contains(layer_at(i))) sums += sums_of(layer_at(i));
  }
  return sums;
}

LayerBlock make_layer_block(const SampleBlock& block, const LayerSet& set, std::size_t pixels) {
  return {block, set, std::vector<double>(sums_of(set) * pixels)};
}

void add_sample(LayerBlock& block, std::size_t pixel, std::uint64_t sample, const LayerSample& value, bool counts) {
  double* sums = &block.sums[pixel * sums_of(block.set)];
  for (std::size_t i = 0; i < kLayers; ++i) {
    const Layer layer = layer_at(i);
    if (!block.set.contains(layer)) continue;
    const std::size_t channels = sums_of(layer);
    if (is_id(layer) ? sample == 0 : counts) {
      const auto values = values_of(value, layer);
      for (std::size_t c = 0; c < channels; ++c) sums[c] += values[c];
    }
    sums += channels;
  }
}

LayerFilm::LayerFilm(const LayerSet& set, int width, int height)
    : set_(set),
      width_(width),
      height_(height),
      stride_(sums_of(set)),
      sums_(stride_ * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

std::size_t LayerFilm::bytes_per_pixel(const LayerSet& set) {
  std::size_t bytes = 2 * sums_of(set) * sizeof(double);
  for (const Layer layer : layers_in(set)) bytes += spec(layer).channels * sizeof(float);
  return bytes;
}

void LayerFilm::fold(const PixelRect& tile, const LayerBlock& block) {
  const bool inside = 0 <= tile.x0 && tile.x0 <= tile.x1 && tile.x1 <= width_ && 0 <= tile.y0 &&
                      tile.y0 <= tile.y1 && tile.y1 <= height_;
  if (!inside || !(block.set == set_) || block.sums.size() != stride_ * tile.pixels()) {
    throw std::invalid_argument("the layers do not fit the film");
  }
  const bool complete = block.block.complete;
  if (!complete && tails_.empty()) tails_.resize(sums_.size());
  const std::size_t row = stride_ * static_cast<std::size_t>(tile.width());
  auto from = block.sums.begin();
  for (int y = tile.y0; y < tile.y1; ++y, from += static_cast<std::ptrdiff_t>(row)) {
    const std::size_t first = stride_ * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                         static_cast<std::size_t>(tile.x0));
    for (std::size_t i = 0; i < row; ++i) {
      const double value = from[static_cast<std::ptrdiff_t>(i)];
      if (complete) sums_[first + i] += value;
      if (!tails_.empty()) tails_[first + i] = complete ? 0.0 : value;
    }
  }
}

LayerFilm LayerFilm::rows(int y0, int y1) const {
  LayerFilm part(set_, width_, 0);
  part.height_ = y1 - y0;
  const auto row = static_cast<std::ptrdiff_t>(stride_) * width_;
  part.sums_.assign(sums_.begin() + row * y0, sums_.begin() + row * y1);
  if (!tails_.empty()) part.tails_.assign(tails_.begin() + row * y0, tails_.begin() + row * y1);
  return part;
}

std::vector<float> LayerFilm::resolve(Layer layer, std::span<const float> samples) const {
  const std::size_t channels = spec(layer).channels, offset = offset_of(set_, layer);
  const std::size_t pixels = stride_ == 0 || !set_.contains(layer) ? 0 : sums_.size() / stride_;
  if (samples.size() < pixels) throw std::invalid_argument("a number of samples for each pixel is needed");
  std::vector<float> values(channels * pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const auto sum = [&](std::size_t c) {
      const std::size_t i = stride_ * pixel + offset + c;
      return tails_.empty() ? sums_[i] : sums_[i] + tails_[i];
    };
    const double count = layer == Layer::kDepth ? sum(1) : static_cast<double>(samples[pixel]);
    for (std::size_t c = 0; c < channels; ++c) {
      double value = 0.0;
      if (is_id(layer)) value = sum(c);
      else if (count > 0.0) value = sum(c) / count;
      else if (layer == Layer::kDepth) value = std::numeric_limits<double>::infinity();
      values[channels * pixel + c] = static_cast<float>(value);
    }
  }
  return values;
}

}  // namespace raykiln::render
