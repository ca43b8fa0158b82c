// What clients ask about jobs.
#include <algorithm>
#include <charconv>

#include "core.hpp"
#include "raykiln/base/ids.hpp"
#include "raykiln/jobs/admission.hpp"
#include "raykiln/scheduler/render_inputs.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kMaxKeyBytes = 200;
constexpr std::size_t kMaxPage = 500;

Error job_not_found(const JobId& id) {
  return {ErrorKind::kNotFound, "job_not_found", "there is no such job", id};
}

std::vector<JobWarning> warnings_of(const SceneReport& report) {
  std::vector<JobWarning> warnings;
  for (const SceneWarning& w : report.warnings) warnings.push_back({w.code, w.message, w.where});
  return warnings;
}

/// What an idempotency key is bound to.
std::string digest_of(const SubmitJob& submission) {
  const std::string digest = request_digest(submission.request);
  return submission.continues.empty() ? digest : digest + ' ' + submission.continues;
}

std::optional<std::uint64_t> read_cursor(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value == 0) return std::nullopt;
  return value;
}

}  // namespace

LiveJob* Scheduler::Core::find(const JobId& id) {
  const auto found = live_.find(id);
  return found == live_.end() ? nullptr : found->second.get();
}

Result<JobSnapshot> Scheduler::Core::snapshot_of(const JobId& id) {
  if (LiveJob* job = find(id)) {
    refresh(*job);
    return job->snapshot;
  }
  auto record = parts_.store.job(id);
  if (!record) return record.error();
  auto decoded = decode_job(record->content);
  if (!decoded) return Error{ErrorKind::kInternal, "internal", "the record of the job is damaged", id};
  return std::move(*decoded);
}

Result<std::optional<SubmittedJob>> Scheduler::Core::earlier_submission(const SubmitJob& s) {
  if (s.idempotency_key.size() > kMaxKeyBytes) {
    return Error{ErrorKind::kInvalid, "invalid_parameter", "the key is too long", "Idempotency-Key"};
  }
  auto earlier = parts_.store.job_with_key(s.idempotency_key);
  if (!earlier) return earlier.error();
  if (!earlier->has_value()) return std::optional<SubmittedJob>();
  if ((*earlier)->request_digest != digest_of(s)) {
    return Error{ErrorKind::kConflict, "idempotency_key_reused",
                 "this key was used for another request", "Idempotency-Key"};
  }
  auto snapshot = snapshot_of((*earlier)->id);
  if (!snapshot) return snapshot.error();
  return std::optional(SubmittedJob{.job = std::move(*snapshot), .created = false});
}

Result<std::optional<SubmittedJob>> Scheduler::Core::equal_result(const JobRequest& request) {
  auto earlier = parts_.store.job_with_result(result_digest(request, config_.engine));
  if (!earlier) return earlier.error();
  if (!earlier->has_value()) return std::optional<SubmittedJob>();
  auto snapshot = snapshot_of((*earlier)->id);
  // Rendered anew where the record is damaged, and where another run may reach what time had cut off.
  const bool usable = snapshot && snapshot->image_revision != 0 &&
                      !(snapshot->request.stop.error && snapshot->done_by == DoneBy::kSeconds);
  if (!usable) return std::optional<SubmittedJob>();
  reused_.add();
  return std::optional(SubmittedJob{.job = std::move(*snapshot), .created = false, .reused = true});
}

Status Scheduler::Core::check_resources(const JobRequest& request) {
  const std::uint64_t bytes = film_memory(request);
  if (bytes > config_.scheduler.max_film_bytes) {
    return Error{ErrorKind::kTooLarge, "film_too_large",
                 (request.layers.empty() ? "the picture needs " : "the picture and its layers need ") +
                     std::to_string(bytes) + " bytes, " +
                     std::to_string(config_.scheduler.max_film_bytes) + " are allowed",
                 "/width"};
  }
  return admit(queue_.size(), config_.scheduler.max_queued_jobs, mean_job_seconds_, active_);
}

Result<SubmittedJob> Scheduler::Core::try_submit(SubmitJob submission) {
  const JobRequest& request = submission.request;
  if (auto valid = validate(request, config_.jobs); !valid) return valid.error();
  if (!submission.idempotency_key.empty()) {
    auto earlier = earlier_submission(submission);
    if (!earlier) return earlier.error();
    if (earlier->has_value()) return std::move(**earlier);
  }
  if (!accepting_) {
    return Error{ErrorKind::kUnavailable, "shutting_down", "the server is stopping", "", 5};
  }
  if (request.reuse) {
    auto there = equal_result(request);
    if (!there) return there.error();
    if (there->has_value()) return std::move(**there);
  }
  auto record = parts_.store.scene(request.scene);
  if (!record) return record.error();
  const auto report = decode_report(record->report);
  if (!report) return Error{ErrorKind::kInternal, "internal", "the record of the scene is damaged", ""};
  if (auto camera = check_camera(request.camera, *report); !camera) return camera.error();
  if (auto room = check_resources(request); !room) return room.error();

  auto job = std::make_unique<LiveJob>();
  job->snapshot.id = random_id("j_");
  job->snapshot.request = request;
  job->snapshot.created = parts_.clock.wall();
  job->snapshot.warnings = warnings_of(*report);
  job->snapshot.progress.samples_target = request.stop.samples *
                                          static_cast<std::uint64_t>(request.width) *
                                          static_cast<std::uint64_t>(request.height);
  job->idempotency_key = submission.idempotency_key;
  job->request_digest = digest_of(submission);
  job->snapshot.continues = submission.continues;
  job->result_digest = result_digest(request, config_.engine);
  if (auto stored = parts_.store.put_job({job->snapshot.id, JobState::kQueued, 1, request.scene,
                                          job->snapshot.created, job->snapshot.created,
                                          job->idempotency_key, job->request_digest,
                                          encode_job(job->snapshot), job->result_digest});
      !stored) {
    return stored.error();
  }
  LiveJob& added = *live_.emplace(job->snapshot.id, std::move(job)).first->second;
  enqueue(added);
  refresh(added);
  parts_.log.info("job_queued", {{"job", added.snapshot.id}, {"scene", request.scene}});
  return SubmittedJob{.job = added.snapshot, .created = true};
}

void Scheduler::Core::enqueue(LiveJob& job) {
  job.order = next_order_++;
  const auto before = [&](const JobId& waiting) {
    return find(waiting)->snapshot.request.priority >= job.snapshot.request.priority;
  };
  queue_.insert(std::partition_point(queue_.begin(), queue_.end(), before), job.snapshot.id);
  queued_gauge_.set(static_cast<double>(queue_.size()));
}

void Scheduler::Core::submit(SubmitJob submission, const Reply<SubmittedJob>& reply) {
  reply(try_submit(std::move(submission)));
  tell_queue_positions();
  pump();
}

void Scheduler::Core::get(const JobId& id, const Reply<JobSnapshot>& reply) {
  reply(snapshot_of(id));
}

void Scheduler::Core::list(const ListJobs& query, const Reply<JobPage>& reply) {
  JobQuery stored;
  stored.states = query.states;
  stored.scene = query.scene;
  stored.limit = std::clamp<std::size_t>(query.limit, 1, kMaxPage) + 1;
  if (!query.cursor.empty()) {
    const auto before = read_cursor(query.cursor);
    if (!before) {
      return reply(Error{ErrorKind::kInvalid, "invalid_parameter", "not a cursor", "cursor"});
    }
    stored.before = *before;
  }
  auto records = parts_.store.jobs(stored);
  if (!records) return reply(records.error());
  JobPage page;
  if (records->size() == stored.limit) {
    records->pop_back();
    page.next_cursor = std::to_string(records->back().sequence);
  }
  for (const JobRecord& record : *records) {
    if (auto snapshot = snapshot_of(record.id)) page.jobs.push_back(std::move(*snapshot));
  }
  reply(std::move(page));
}

void Scheduler::Core::cancel(const JobId& id, const Reply<JobSnapshot>& reply) {
  LiveJob* job = find(id);
  if (job == nullptr) {
    auto snapshot = snapshot_of(id);
    if (snapshot && snapshot->state != JobState::kCancelled) {
      return reply(Error{ErrorKind::kConflict, "job_finished",
                         "the job is " + std::string(name(snapshot->state)), ""});
    }
    return reply(std::move(snapshot));
  }
  const bool rendering = job->snapshot.state == JobState::kRendering;
  if (rendering && job->ending) {
    // Its outcome is certain, only the picture is still being stored.
    return reply(Error{ErrorKind::kConflict, "job_finished", "the job has just ended", ""});
  }
  std::optional<JobSnapshot> after;
  if (rendering) {
    transition(*job, JobEvent::kCancel);
    refresh(*job);
    after = job->snapshot;
    begin_ending(*job, JobEvent::kDrained, std::nullopt);
  } else if (job->snapshot.state == JobState::kCancelling) {
    after = job->snapshot;
  } else {
    transition(*job, JobEvent::kCancel);  // final: the job is gone from live_
    after = snapshot_of(id).ok() ? std::optional(*snapshot_of(id)) : std::nullopt;
  }
  if (after) {
    reply(std::move(*after));
  } else {
    reply(job_not_found(id));
  }
  pump();
}

void Scheduler::Core::watch(const JobId& id, std::function<void()> wake,
                            const Reply<std::unique_ptr<Subscription>>& reply, Seat seat) {
  auto snapshot = snapshot_of(id);
  if (!snapshot) return reply(snapshot.error());
  reply(hub_.subscribe(std::make_shared<const JobSnapshot>(std::move(*snapshot)), std::move(wake), seat));
}

void Scheduler::Core::status(const Reply<SchedulerStatus>& reply) {
  reply(SchedulerStatus{accepting_, queue_.size(), active_, hub_.clients()});
}

}  // namespace raykiln::server
