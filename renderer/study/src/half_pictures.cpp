#include "half_pictures.hpp"

#include <time.h>

#include <algorithm>
#include <functional>

namespace raykiln::render {
namespace {

constexpr int kBandRows = 8;

double thread_seconds() {
  timespec now{};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

RenderSettings with_seed(RenderSettings settings, std::uint64_t seed) {
  settings.seed = seed;
  return settings;
}

/// A band of rows of one half.
struct Band {
  std::size_t half;
  PixelRect rect;
  TileResult result{};
  double seconds = 0.0;
};

}  // namespace

HalfPictures::HalfPictures(std::shared_ptr<const PreparedScene> scene, const RenderSettings& settings,
                           std::array<std::uint64_t, 2> seeds)
    : scene_(std::move(scene)),
      settings_{with_seed(settings, seeds[0]), with_seed(settings, seeds[1])},
      films_{make_film(settings), make_film(settings)} {}

void HalfPictures::advance(TaskRunner& runner) {
  const std::uint64_t until = std::max<std::uint64_t>(1, 2 * each_);
  auto blocks = blocks_for(until);
  std::erase_if(blocks, [this](const SampleBlock& block) { return block.first < each_; });
  std::vector<Band> bands;
  for (std::size_t half = 0; half < 2; ++half) {
    const int width = settings_[half].width, height = settings_[half].height;
    for (int y = 0; y < height; y += kBandRows) {
      bands.push_back({half, {0, y, width, std::min(y + kBandRows, height)}});
    }
  }
  std::vector<std::function<void()>> tasks;
  tasks.reserve(bands.size());
  for (Band& band : bands) {
    tasks.emplace_back([this, &band, &blocks] {
      const double begun = thread_seconds();
      band.result = render_tile(*scene_, settings_[band.half], band.rect, blocks, {});
      band.seconds = thread_seconds() - begun;
    });
  }
  runner.run(tasks);
  for (const Band& band : bands) {
    merge(films_[band.half], band.result);
    seconds_ += band.seconds;
  }
  each_ = until;
}

std::vector<double> HalfPictures::half(std::size_t which) const {
  const Film& film = films_[which];
  const auto pixels = static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
  std::vector<double> means(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const PixelSums sums = film.pixel(i);
    const auto n = static_cast<double>(std::max<std::uint64_t>(sums.samples(), 1));
    for (std::size_t c = 0; c < 3; ++c) means[3 * i + c] = sums.beauty[c] / n;
  }
  return means;
}

std::vector<double> HalfPictures::whole() const {
  std::vector<double> mean = half(0);
  const std::vector<double> other = half(1);
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5 * (mean[i] + other[i]);
  return mean;
}

}  // namespace raykiln::render
