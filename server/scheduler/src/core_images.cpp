// Pictures on demand.
#include <algorithm>

#include "core.hpp"
#include "image_layers.hpp"

namespace raykiln::server {
namespace {

std::shared_ptr<JobImage> framed(const JobSnapshot& job) {
  auto image = std::make_shared<JobImage>();
  image->job = job.id;
  image->revision = job.image_revision;
  image->is_final = is_final(job.state);
  image->scene = job.request.scene;
  image->request = job.request;
  image->effects = job.effects;
  image->samples_per_pixel = job.progress.samples_per_pixel;
  image->render_seconds = job.statistics.render_seconds;
  return image;
}

Error image_not_ready() {
  return {ErrorKind::kNotFound, "image_not_ready", "there is no picture yet", "", 1};
}
/// To ask again would not help: it was cancelled before its first sample, or its picture could not be stored.
Error ended_without_image() {
  return {ErrorKind::kNotFound, "image_not_ready", "the job ended without a picture", ""};
}

}  // namespace

JobImagePtr Scheduler::Core::resolve(LiveJob& job, bool layers) {
  const SteadyTime begin = parts_.clock.steady();
  auto image = framed(job.snapshot);
  image->image = job.picture;
  if (layers) add_layers(*image, *job.film, job.layers.get(), job.pixel_seconds);
  job.snapshot.statistics.publish_seconds += seconds_between(begin, parts_.clock.steady());
  return image;
}

/// Nothing is merged any more: the picture itself, not a copy, which would take a tenth of a second.
std::shared_ptr<JobImage> Scheduler::Core::last_picture_of(LiveJob& job) {
  auto image = framed(job.snapshot);
  image->image = std::move(job.picture);
  return image;
}

JobImagePtr Scheduler::Core::remembered(const JobId& id, std::uint64_t revision,
                                              bool layers) const {
  for (const JobImagePtr& image : images_) {
    const bool enough = !layers || image->is_final || !image->error.empty();
    if (image->job == id && image->revision == revision && enough) return image;
  }
  return nullptr;
}

void Scheduler::Core::remember(JobImagePtr image) {
  std::erase_if(images_, [&](const JobImagePtr& old) { return old->job == image->job; });
  images_.push_back(std::move(image));
  if (images_.size() > config_.scheduler.max_cached_images) images_.erase(images_.begin());
}

void Scheduler::Core::image(const JobId& id, const std::string& layer,
                            const Reply<JobImagePtr>& reply) {
  const bool layers = layer == "all";
  if (layer != "beauty" && !layers) {
    return reply(Error{ErrorKind::kInvalid, "invalid_parameter", "there is no such layer", "layer"});
  }
  auto snapshot = snapshot_of(id);
  if (!snapshot) return reply(snapshot.error());
  if (snapshot->image_revision == 0) return reply(is_final(snapshot->state) ? ended_without_image() : image_not_ready());
  if (auto known = remembered(id, snapshot->image_revision, layers)) return reply(std::move(known));
  LiveJob* job = find(id);
  if (job == nullptr) return load_image(*snapshot, reply);
  if (job->last_picture) return layers ? image_when_stored(id, layer, reply) : reply(job->last_picture);
  if (!job->film) return reply(image_not_ready());
  if (layers && is_large(*job)) return gather_layers(*job, framed(*snapshot), reply);
  JobImagePtr fresh = resolve(*job, layers);
  remember(fresh);
  reply(std::move(fresh));
}

/// Asked again behind what the disk does for the job by now.
void Scheduler::Core::image_when_stored(const JobId& id, const std::string& layer, const Reply<JobImagePtr>& reply) {
  disk_.post([this, id, layer, reply] {
    post([this, id, layer, reply] { image(id, layer, reply); });
  });
}

void Scheduler::Core::load_image(const JobSnapshot& job, const Reply<JobImagePtr>& reply) {
  disk_.post([this, job, reply] {
    auto stored = parts_.store.image(job.id);
    if (!stored) return reply(stored.error());
    auto image = framed(job);
    image->image = render::Image{stored->width, stored->height, std::move(stored->rgb)};
    image->error = std::move(stored->error);
    image->samples = std::move(stored->samples);
    image->seconds = std::move(stored->seconds);
    image->layers = std::move(stored->layers);
    strand_->post([this, image] { remember(image); });
    reply(JobImagePtr(image));
  });
}

}  // namespace raykiln::server
