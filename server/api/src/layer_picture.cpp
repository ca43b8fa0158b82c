#include "layer_picture.hpp"

#include <algorithm>

#include "raykiln/image/layers.hpp"

namespace raykiln::server {
namespace {

bool is_measured(const std::string& layer) { return layer == "error" || layer == "samples" || layer == "seconds"; }

const std::vector<float>& values_of(const JobImage& image, const std::string& layer) {
  static const std::vector<float> kNone;
  const auto found = std::find_if(image.layers.begin(), image.layers.end(),
                                  [&](const StoredLayer& one) { return one.name == layer; });
  return found == image.layers.end() ? kNone : found->values;
}

/// One value a pixel: of errors their luminance.
std::vector<float> map_values(const JobImage& image, const std::string& layer) {
  if (layer == "samples") return image.samples;
  if (layer == "seconds") return image.seconds;
  if (layer != "error") return values_of(image, layer);
  std::vector<float> values(image.error.size() / 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(render::luminance({image.error[3 * i], image.error[3 * i + 1], image.error[3 * i + 2]}));
  }
  return values;
}

render::ValueRange range_of(const std::vector<float>& values, const std::string& layer) {
  const bool linear = layer == "samples" || layer == "depth";
  return render::value_range(values, linear ? render::ValueScale::kLinear : render::ValueScale::kLog);
}

}  // namespace

LayerLook look_of(const std::string& layer) {
  if (layer == "beauty") return LayerLook::kLight;
  if (is_measured(layer)) return LayerLook::kMap;
  const auto known = render::layer_named(layer);
  if (!known) return LayerLook::kUnknown;
  switch (*known) {
    case render::Layer::kDepth: return LayerLook::kMap;
    case render::Layer::kNormal:
    case render::Layer::kObjectId:
    case render::Layer::kMaterialId: return LayerLook::kOther;
    case render::Layer::kAlbedo:
    case render::Layer::kEmission:
    case render::Layer::kDirect:
    case render::Layer::kIndirect: break;
  }
  return LayerLook::kLight;
}

std::string layer_choices() { return "beauty, error, samples, seconds, " + render::all_layer_names(); }

bool has_layer(const JobImage& image, const std::string& layer) {
  const std::size_t pixels = image.image.rgb.size() / 3;
  if (layer == "beauty") return true;
  if (layer == "seconds") return image.seconds.size() == pixels;
  if (is_measured(layer)) return image.error.size() == 3 * pixels;
  const auto known = render::layer_named(layer);
  return known && values_of(image, layer).size() == render::spec(*known).channels * pixels;
}

render::Image layer_picture(const JobImage& image, const std::string& layer) {
  if (layer == "beauty") return image.image;
  const int width = image.image.width, height = image.image.height;
  if (look_of(layer) == LayerLook::kMap) {
    const auto values = map_values(image, layer);
    return render::false_colour(values, width, height, range_of(values, layer));
  }
  const auto& values = values_of(image, layer);
  if (look_of(layer) == LayerLook::kLight) return {width, height, values};
  if (layer == render::spec(render::Layer::kNormal).name) return render::direction_colours(values, width, height);
  return render::id_colours(values, width, height);
}

render::ValueRange layer_range(const JobImage& image, const std::string& layer) {
  return range_of(map_values(image, layer), layer);
}

}  // namespace raykiln::server
