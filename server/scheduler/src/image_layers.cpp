#include "image_layers.hpp"

#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/scheduler/layers.hpp"

namespace raykiln::server {

std::vector<StoredLayer> resolved(const render::LayerFilm* film, std::span<const float> samples) {
  std::vector<StoredLayer> layers;
  if (film == nullptr) return layers;
  for (const render::Layer layer : render::layers_in(film->set())) {
    layers.push_back({std::string(render::spec(layer).name), film->resolve(layer, samples)});
  }
  return layers;
}

render::ExtraPlane exr_plane(const StoredLayer& layer) {
  render::ExtraPlane plane{layer.name, layer.values};
  if (const auto known = render::layer_named(layer.name)) plane.channels = render::spec(*known).exr_channels;
  return plane;
}

void add_layers(JobImage& image, const render::Film& film, const render::LayerFilm* layers,
                const std::vector<float>& seconds) {
  const auto errors = render::pixel_errors(film).standard_error;
  image.error.assign(errors.size(), 0.0F);
  for (std::size_t i = 0; i < errors.size(); ++i) image.error[i] = static_cast<float>(errors[i]);
  image.samples.resize(errors.size() / 3);
  for (std::size_t i = 0; i < image.samples.size(); ++i) {
    image.samples[i] = static_cast<float>(film.pixel(i).samples());
  }
  image.seconds = seconds;
  image.layers = resolved(layers, image.samples);
}

}  // namespace raykiln::server
