#include "image_layers.hpp"

#include "raykiln/accuracy/pixel_error.hpp"

namespace raykiln::server {

void add_layers(JobImage& image, const render::Film& film, const std::vector<float>& seconds) {
  const auto errors = render::pixel_errors(film).standard_error;
  image.error.assign(errors.size(), 0.0F);
  for (std::size_t i = 0; i < errors.size(); ++i) image.error[i] = static_cast<float>(errors[i]);
  image.samples.resize(errors.size() / 3);
  for (std::size_t i = 0; i < image.samples.size(); ++i) {
    image.samples[i] = static_cast<float>(film.pixel(i).samples());
  }
  image.seconds = seconds;
}

}  // namespace raykiln::server
