// Layers of a large picture that is being rendered. To make them takes seconds: a strip of its films is copied on the
// strand, read on the thread of the disk, and then comes the next. Rows of different strips may be of different moments, none older
// than the revision; all that there is of a pixel is of the same samples.
#include <algorithm>
#include <utility>

#include "core.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/scheduler/layers.hpp"

namespace raykiln::server {
namespace {

/// Rows on either side that the errors of a strip are drawn to.
constexpr int kMargin = 1;
/// Who may wait for the layers of one picture. Far more than there are threads of the HTTP server to wait with.
constexpr std::size_t kMostWaiting = 64;

/// Rows y0 <= y < y1 of a film, with those that their errors need.
struct Strip {
  int y0 = 0, y1 = 0, first = 0;
  render::SampleRelation relation{};
  std::vector<render::PixelSums> pixels;  ///< from row `first` on
  std::vector<float> rgb, seconds;        ///< of y0 to y1 alone
  std::optional<render::LayerFilm> layers{};  ///< of y0 to y1 alone, where the job asks for some
};

Strip strip_of(const LiveJob& job, int y0, int y1) {
  const render::Film& film = *job.film;
  const int width = film.width(), last = std::min(film.height(), y1 + kMargin);
  const std::ptrdiff_t begin = std::ptrdiff_t{y0} * width, end = std::ptrdiff_t{y1} * width;
  Strip strip{.y0 = y0, .y1 = y1, .first = std::max(0, y0 - kMargin), .relation = film.relation(), .pixels = {}, .rgb = {}, .seconds = {}};
  strip.pixels.reserve(static_cast<std::size_t>(last - strip.first) * static_cast<std::size_t>(width));
  for (std::ptrdiff_t i = std::ptrdiff_t{strip.first} * width; i < std::ptrdiff_t{last} * width; ++i) {
    strip.pixels.push_back(film.pixel(static_cast<std::size_t>(i)));
  }
  strip.rgb.assign(job.picture.rgb.begin() + 3 * begin, job.picture.rgb.begin() + 3 * end);
  strip.seconds.assign(job.pixel_seconds.begin() + begin, job.pixel_seconds.begin() + end);
  if (job.layers) strip.layers = job.layers->rows(y0, y1);
  return strip;
}

void make_room(JobImage& image, int width, int height) {
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  image.image = {width, height, std::vector<float>(3 * pixels)};
  image.error.resize(3 * pixels);
  image.samples.resize(pixels);
  image.seconds.resize(pixels);
}

/// `first`: pixel at which the part begins.
void put_layers(JobImage& image, const render::LayerFilm& part, std::ptrdiff_t first, std::size_t pixels) {
  const auto found = resolved(&part, std::span(image.samples).subspan(static_cast<std::size_t>(first), pixels));
  const std::size_t in_all = image.samples.size();
  if (image.layers.empty()) {
    for (const StoredLayer& layer : found) image.layers.push_back({layer.name, std::vector<float>(layer.values.size() / pixels * in_all)});
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto channels = static_cast<std::ptrdiff_t>(found[i].values.size() / pixels);
    std::copy(found[i].values.begin(), found[i].values.end(), image.layers[i].values.begin() + channels * first);
  }
}

void put_strip(JobImage& image, const Strip& strip, int width, int height) {
  if (strip.y0 == 0) make_room(image, width, height);
  const auto errors = render::pixel_errors(strip.pixels, width, strip.relation).standard_error;
  const std::ptrdiff_t begin = std::ptrdiff_t{strip.y0} * width, pixels = std::ptrdiff_t{strip.y1 - strip.y0} * width;
  const std::ptrdiff_t above = std::ptrdiff_t{strip.y0 - strip.first} * width;
  std::copy(strip.rgb.begin(), strip.rgb.end(), image.image.rgb.begin() + 3 * begin);
  std::copy(strip.seconds.begin(), strip.seconds.end(), image.seconds.begin() + begin);
  std::transform(errors.begin() + 3 * above, errors.begin() + 3 * (above + pixels), image.error.begin() + 3 * begin,
                 [](double error) { return static_cast<float>(error); });
  std::transform(strip.pixels.begin() + above, strip.pixels.begin() + above + pixels, image.samples.begin() + begin,
                 [](const render::PixelSums& sums) { return static_cast<float>(sums.samples()); });
  if (strip.layers) put_layers(image, *strip.layers, begin, static_cast<std::size_t>(pixels));
}

}  // namespace

/// Those who ask meanwhile get the same, as far as there is room for them to wait.
void Scheduler::Core::gather_layers(LiveJob& job, std::shared_ptr<JobImage> image, const Reply<JobImagePtr>& reply) {
  if (job.gathering) {
    if (job.gathering->waiting.size() < kMostWaiting) return job.gathering->waiting.push_back(reply);
    return reply(Error{ErrorKind::kNotFound, "image_not_ready", "too many wait for the layers of this picture", "layer", 1});
  }
  job.gathering = std::make_shared<Gathering>();
  job.gathering->image = std::move(image);
  job.gathering->waiting.push_back(reply);
  gather_strip(job.gathering);
}

void Scheduler::Core::gather_strip(const std::shared_ptr<Gathering>& gathering) {
  LiveJob* job = find(gathering->image->job);
  // Its picture and film belong to what stores them from then on, and whoever waits is answered from there.
  if (job == nullptr || job->archiving || !job->film) return gathered(gathering, false);
  const SteadyTime begin = parts_.clock.steady();
  const int width = job->film->width(), height = job->film->height(), y0 = gathering->rows;
  const int y1 = std::min(height, y0 + std::max(1, parts_.judged_at_once_px / width));
  auto strip = std::make_shared<const Strip>(strip_of(*job, y0, y1));
  job->snapshot.statistics.publish_seconds += seconds_between(begin, parts_.clock.steady());
  disk_.post([this, gathering, strip, width, height] {
    bool made = true;
    try {
      put_strip(*gathering->image, *strip, width, height);
    } catch (const std::exception& fault) {
      made = false;
      parts_.log.error("layers_not_made", {{"job", gathering->image->job}, {"why", fault.what()}});
    }
    post([this, gathering, made, height, rows = strip->y1] {
      gathering->rows = rows;
      if (!made) return not_gathered(gathering);
      return rows < height ? gather_strip(gathering) : gathered(gathering, true);
    });
  });
}

/// Not whole: the job has ended meanwhile, and everybody asks anew.
void Scheduler::Core::gathered(const std::shared_ptr<Gathering>& gathering, bool whole) {
  const JobId id = gathering->image->job;
  if (LiveJob* job = find(id)) job->gathering.reset();
  if (whole) remember(gathering->image);
  for (const auto& reply : std::exchange(gathering->waiting, {})) {
    if (whole) reply(JobImagePtr(gathering->image));
    else image(id, "all", reply);
  }
}

void Scheduler::Core::not_gathered(const std::shared_ptr<Gathering>& gathering) {
  if (LiveJob* job = find(gathering->image->job)) job->gathering.reset();
  for (const auto& reply : gathering->waiting) {
    reply(Error{ErrorKind::kNotFound, "image_not_ready", "there is no memory for the layers now", "layer", 1});
  }
}

}  // namespace raykiln::server
