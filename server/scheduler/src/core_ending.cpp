// From the last sample to the final state.
#include <algorithm>
#include <utility>

#include "core.hpp"
#include "image_layers.hpp"
#include "raykiln/scheduler/judge_picture.hpp"

namespace raykiln::server {
namespace {

/// The job has ended as it was told to; that its picture is gone is said beside.
void lose_picture(JobSnapshot& job, const Error& why) {
  job.image_revision = 0;
  job.warnings.push_back({"image_not_stored", "the picture could not be stored and is lost: " + why.message, ""});
}

}  // namespace

/// From here on nothing is merged. The state follows when no task is in flight and the picture stored.
void Scheduler::Core::begin_ending(LiveJob& job, JobEvent event, std::optional<Error> error) {
  refresh(job);
  if (event == JobEvent::kRendered && live_.size() == 1) {
    // Workers that had nothing left to do while the last tasks ran.
    const SteadyTime now = parts_.clock.steady();
    for (const auto& entry : worker_free_since_) {
      const double idle = seconds_between(std::max(entry.second, job.render_since), now);
      if (idle > 0.0) job.snapshot.statistics.idle_seconds += idle;
    }
  }
  job.ending = event;
  job.ending_error = std::move(error);
  job.stop.request_stop();
  job.plan->abandon();
  archive_if_drained(job);
}

/// So that to make, read or judge its film takes longer than the strand may be held up.
bool Scheduler::Core::is_large(const LiveJob& job) const {
  return job.settings.width * job.settings.height > parts_.judged_at_once_px;
}

void Scheduler::Core::archive_if_drained(LiveJob& job) {
  if (job.in_flight > 0 || job.archiving) return;
  job.archiving = true;
  const JobId id = job.snapshot.id;
  if (job.snapshot.progress.samples_done == 0) return archived(id, success(), nullptr, std::nullopt);
  if (*job.ending == JobEvent::kDrained && is_large(job)) return end_at_once(job);
  job.last_picture = last_picture_of(job);
  // Nothing is merged any more: the film is read, and its error judged, where it holds up nobody.
  disk_.post([this, id, beauty = job.last_picture, film = std::shared_ptr<const render::Film>(job.film),
              layers = std::shared_ptr<const render::LayerFilm>(job.layers),
              seconds = std::move(job.pixel_seconds),
              samples_area = job.snapshot.request.pixel_mode == PixelMode::kRandom] {
    Status saved = success();
    std::optional<PictureError> error;
    std::shared_ptr<JobImage> image;
    try {
      image = std::make_shared<JobImage>(*beauty);
      error = judge_picture(*film, samples_area);
      add_layers(*image, *film, layers.get(), seconds);
      const auto& picture = image->image;
      saved = parts_.store.put_image(id, {picture.width, picture.height, picture.rgb, image->error,
                                          image->samples, image->seconds, image->layers});
    } catch (const std::exception& fault) {
      saved = Error{ErrorKind::kInternal, "internal", fault.what(), ""};
    }
    post([this, id, saved, image, error] { archived(id, saved, image, error); });
  });
}

/// Who cancels a large picture does not wait until it is stored, which takes seconds: it is looked at, not judged in
/// full, and its layers can be had when they are on the disk.
void Scheduler::Core::end_at_once(LiveJob& job) {
  const JobId id = job.snapshot.id;
  const auto image = last_picture_of(job);
  const bool samples_area = job.snapshot.request.pixel_mode == PixelMode::kRandom;
  job.stored_later = true;
  disk_.post([this, id, image, film = std::shared_ptr<const render::Film>(job.film),
              of_film = std::shared_ptr<const render::LayerFilm>(job.layers),
              seconds = std::move(job.pixel_seconds), bytes = job.snapshot.statistics.film_bytes]() mutable {
    Status saved = success();
    try {
      JobImage layers;
      add_layers(layers, *film, of_film.get(), seconds);
      const render::Image& picture = image->image;  // what archived() changes is around it
      saved = parts_.store.put_image(id, {picture.width, picture.height, picture.rgb, layers.error, layers.samples,
                                          layers.seconds, layers.layers});
    } catch (const std::exception& fault) {
      saved = Error{ErrorKind::kInternal, "internal", fault.what(), ""};
    }
    film.reset();
    of_film.reset();
    if (!saved) parts_.log.error("image_not_stored", {{"job", id}, {"why", saved.error().message}});
    post([this, id, bytes, saved] {
      if (!saved) picture_lost(id, saved.error());
      active_film_bytes_ -= bytes;
      pump();
    });
  });
  archived(id, success(), image, look_at_picture(*job.film, samples_area));
}

/// The record of a job that has ended names no picture that nobody keeps, and says why.
void Scheduler::Core::picture_lost(const JobId& id, const Error& why) {
  std::erase_if(images_, [&](const JobImagePtr& old) { return old->job == id; });
  auto record = parts_.store.job(id);
  if (!record) return;  // forgotten meanwhile
  auto snapshot = decode_job(record->content);
  if (!snapshot) return;
  lose_picture(*snapshot, why);
  record->revision = ++snapshot->revision;
  record->content = encode_job(*snapshot);
  if (auto stored = parts_.store.put_job(*record); !stored) {
    parts_.log.error("job_not_stored", {{"job", id}, {"why", stored.error().message}});
  }
}

void Scheduler::Core::archived(const JobId& id, const Status& saved, const std::shared_ptr<JobImage>& image,
                               std::optional<PictureError> found) {
  LiveJob* job = find(id);
  if (job == nullptr) return;
  if (found) note_error(*job, std::move(*found), job->snapshot.statistics);
  JobEvent event = *job->ending;
  auto error = std::move(job->ending_error);
  if (!saved) {
    parts_.log.error("image_not_stored", {{"job", id}, {"why", saved.error().message}});
    // A picture that would be gone after a restart is not a completed job.
    if (event == JobEvent::kRendered) {
      event = JobEvent::kFail;
      error = saved.error();
    }
    let_go(std::exchange(job->film, nullptr));  // else the final state would name a picture that nobody keeps
    lose_picture(job->snapshot, saved.error());
  }
  if (saved && image) {
    image->revision = job->snapshot.revision + 1;
    image->is_final = !image->error.empty();  // else its layers are still to come
    image->samples_per_pixel = job->snapshot.progress.samples_per_pixel;
    image->render_seconds = job->snapshot.statistics.render_seconds;
    if (event == JobEvent::kRendered) keep_film(*job, *image);
    remember(image);
  }
  transition(*job, event, std::move(error));
  pump();
}

}  // namespace raykiln::server
