// The text form of a job. Keys are added, never re-used with another meaning.
#include <algorithm>
#include <charconv>

#include "raykiln/base/error_record.hpp"
#include "raykiln/base/record.hpp"
#include "raykiln/base/wall_micros.hpp"
#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/jobs/request_record.hpp"
#include "accuracy_record.hpp"

namespace raykiln::server {
namespace {

std::optional<WallTime> read_time(const RecordReader& record, std::string_view key) {
  if (!record.has(key)) return std::nullopt;
  return from_micros(record.integer(key));
}

void write_camera(RecordWriter& record, const CameraChoice& choice) {
  if (const auto* index = std::get_if<int>(&choice)) {
    record.integer("camera.index", *index);
  } else if (const auto* text = std::get_if<std::string>(&choice)) {
    record.text("camera.name", *text);
  } else {
    const auto& own = std::get<OwnCamera>(choice);
    for (const double c : own.eye) record.real("camera.eye", c);
    for (const double c : own.look_at) record.real("camera.look_at", c);
    for (const double c : own.up) record.real("camera.up", c);
    record.real("camera.fov_deg", own.fov_deg);
    if (own.view_height) record.real("camera.view_height", *own.view_height);
  }
}

std::array<double, 3> read_point(const RecordReader& record, std::string_view key) {
  std::array<double, 3> point{};
  const auto& list = record.list(key);
  for (std::size_t i = 0; i < std::min<std::size_t>(list.size(), 3); ++i) {
    std::from_chars(list[i].data(), list[i].data() + list[i].size(), point[i]);
  }
  return point;
}

CameraChoice read_camera(const RecordReader& record) {
  if (record.has("camera.name")) return record.text("camera.name");
  if (!record.has("camera.eye")) return static_cast<int>(record.integer("camera.index"));
  OwnCamera own;
  own.eye = read_point(record, "camera.eye");
  own.look_at = read_point(record, "camera.look_at");
  own.up = read_point(record, "camera.up");
  own.fov_deg = record.real("camera.fov_deg", own.fov_deg);
  if (record.has("camera.view_height")) own.view_height = record.real("camera.view_height");
  return own;
}

/// Nothing where they are the defaults.
void write_lens_and_crop(RecordWriter& r, const JobRequest& q) {
  if (q.lens) {
    r.real("lens.radius", q.lens->radius);
    r.real("lens.focus_distance", q.lens->focus_distance);
  }
  if (!q.crop) return;
  r.integer("crop.x", q.crop->x);
  r.integer("crop.y", q.crop->y);
  r.integer("crop.full_width", q.crop->full_width);
  r.integer("crop.full_height", q.crop->full_height);
}

void read_lens_and_crop(const RecordReader& r, JobRequest& q) {
  if (r.has("lens.radius")) q.lens = Lens{r.real("lens.radius"), r.real("lens.focus_distance", 1.0)};
  if (!r.has("crop.x")) return;
  q.crop = Crop{static_cast<int>(r.integer("crop.x")), static_cast<int>(r.integer("crop.y")),
                static_cast<int>(r.integer("crop.full_width", q.width)),
                static_cast<int>(r.integer("crop.full_height", q.height))};
}

void write_tree_budget(RecordWriter& r, const TreeBudget& tree) {
  if (tree.references_per_triangle != TreeBudget{}.references_per_triangle) {
    r.real("tree.references_per_triangle", tree.references_per_triangle);
  }
  if (tree.max_bytes) r.natural("tree.max_bytes", *tree.max_bytes);
}

TreeBudget read_tree_budget(const RecordReader& r) {
  TreeBudget tree;
  tree.references_per_triangle = r.real("tree.references_per_triangle", tree.references_per_triangle);
  if (r.has("tree.max_bytes")) tree.max_bytes = r.natural("tree.max_bytes");
  return tree;
}

void write_tree(RecordWriter& r, const std::optional<TreeFigures>& tree) {
  if (!tree) return;
  r.natural("stat.tree.references", tree->references);
  r.natural("stat.tree.bytes", tree->bytes);
  r.natural("stat.tree.peak_bytes", tree->peak_bytes);
  r.integer("stat.tree.budget_reached", tree->budget_reached ? 1 : 0);
}

std::optional<TreeFigures> read_tree(const RecordReader& r) {
  if (!r.has("stat.tree.references")) return std::nullopt;
  return TreeFigures{r.natural("stat.tree.references"), r.natural("stat.tree.bytes"),
                     r.natural("stat.tree.peak_bytes"), r.integer("stat.tree.budget_reached") != 0};
}

void write_statistics(RecordWriter& r, const JobStatistics& s) {
  r.real("stat.prepare_seconds", s.prepare_seconds);
  if (s.tree_build_seconds) r.real("stat.tree_build_seconds", *s.tree_build_seconds);
  write_tree(r, s.tree);
  r.real("stat.render_seconds", s.render_seconds);
  r.real("stat.worker_seconds", s.worker_seconds);
  r.real("stat.idle_seconds", s.idle_seconds);
  r.real("stat.merge_seconds", s.merge_seconds);
  r.real("stat.publish_seconds", s.publish_seconds);
  r.real("stat.accuracy_seconds", s.accuracy_seconds);
  r.natural("stat.tasks", s.tasks);
  r.natural("stat.retried_tasks", s.retried_tasks);
  r.natural("stat.paths", s.paths);
  r.natural("stat.camera_rays", s.camera_rays);
  r.natural("stat.bounce_rays", s.bounce_rays);
  r.natural("stat.shadow_rays", s.shadow_rays);
  r.natural("stat.non_finite", s.non_finite);
  r.natural("stat.negative", s.negative);
  r.natural("stat.truncated", s.truncated);
  r.natural("stat.roulette_ends", s.roulette_ends);
  r.natural("stat.lights_at_hits", s.lights_at_hits);
  r.natural("stat.stream_calls", s.stream_calls);
  r.natural("stat.short_stream_calls", s.short_stream_calls);
  r.real("stat.traversal_seconds", s.traversal_seconds);
  r.real("stat.shading_seconds", s.shading_seconds);
  r.natural("stat.film_bytes", s.film_bytes);
  for (const LocatedSample& bad : s.bad_samples) {
    r.integer("bad.x", bad.x);
    r.integer("bad.y", bad.y);
    r.natural("bad.sample", bad.sample);
  }
}

template <class Number>
Number number_at(const std::vector<std::string>& list, std::size_t i) {
  Number value{};
  if (i < list.size()) std::from_chars(list[i].data(), list[i].data() + list[i].size(), value);
  return value;
}

std::string text_at(const std::vector<std::string>& list, std::size_t i) {
  return i < list.size() ? list[i] : std::string();
}

JobStatistics read_statistics(const RecordReader& r) {
  JobStatistics s;
  s.prepare_seconds = r.real("stat.prepare_seconds");
  if (r.has("stat.tree_build_seconds")) s.tree_build_seconds = r.real("stat.tree_build_seconds");
  s.tree = read_tree(r);
  s.render_seconds = r.real("stat.render_seconds");
  s.worker_seconds = r.real("stat.worker_seconds");
  s.idle_seconds = r.real("stat.idle_seconds");
  s.merge_seconds = r.real("stat.merge_seconds");
  s.publish_seconds = r.real("stat.publish_seconds");
  s.accuracy_seconds = r.real("stat.accuracy_seconds");
  s.tasks = r.natural("stat.tasks");
  s.retried_tasks = r.natural("stat.retried_tasks");
  s.paths = r.natural("stat.paths");
  s.camera_rays = r.natural("stat.camera_rays");
  s.bounce_rays = r.natural("stat.bounce_rays");
  s.shadow_rays = r.natural("stat.shadow_rays");
  s.non_finite = r.natural("stat.non_finite");
  s.negative = r.natural("stat.negative");
  s.truncated = r.natural("stat.truncated");
  s.roulette_ends = r.natural("stat.roulette_ends");
  s.lights_at_hits = r.natural("stat.lights_at_hits");
  s.stream_calls = r.natural("stat.stream_calls");
  s.short_stream_calls = r.natural("stat.short_stream_calls");
  s.traversal_seconds = r.real("stat.traversal_seconds");
  s.shading_seconds = r.real("stat.shading_seconds");
  s.film_bytes = r.natural("stat.film_bytes");
  for (std::size_t i = 0; i < r.list("bad.x").size(); ++i) {
    s.bad_samples.push_back({number_at<int>(r.list("bad.x"), i), number_at<int>(r.list("bad.y"), i),
                             number_at<std::uint64_t>(r.list("bad.sample"), i)});
  }
  return s;
}

void write_progress(RecordWriter& r, const RenderProgress& p) {
  r.natural("progress.samples_done", p.samples_done);
  r.natural("progress.samples_target", p.samples_target);
  r.real("progress.samples_per_pixel", p.samples_per_pixel);
  r.real("progress.stop_fraction", p.stop_fraction);
  r.integer("progress.tiles", p.tiles);
  r.integer("progress.tiles_started", p.tiles_started);
  r.integer("progress.tiles_done", p.tiles_done);
}

RenderProgress read_progress(const RecordReader& r) {
  RenderProgress p;
  p.samples_done = r.natural("progress.samples_done");
  p.samples_target = r.natural("progress.samples_target");
  p.samples_per_pixel = r.real("progress.samples_per_pixel");
  p.stop_fraction = r.real("progress.stop_fraction");
  p.tiles = static_cast<int>(r.integer("progress.tiles"));
  p.tiles_started = static_cast<int>(r.integer("progress.tiles_started"));
  p.tiles_done = static_cast<int>(r.integer("progress.tiles_done"));
  return p;
}

}  // namespace

void write_request(RecordWriter& r, const JobRequest& q) {
  r.text("name", q.name);
  r.text("scene", q.scene);
  write_camera(r, q.camera);
  r.integer("width", q.width);
  r.integer("height", q.height);
  r.natural("stop.samples", q.stop.samples);
  if (q.stop.seconds) r.real("stop.seconds", *q.stop.seconds);
  if (q.stop.error) r.real("stop.error", *q.stop.error);
  for (const std::uint64_t samples : q.stop.tile_samples) r.natural("stop.tile_samples", samples);
  r.text("light_model", name(q.light_model));
  r.text("light_model_overrides", overrides_text(q.light_model_overrides));
  r.integer("max_depth", depth_limit(q));
  r.natural("seed", q.seed);
  r.integer("tile", q.tile);
  r.integer("priority", q.priority);
  r.integer("branches", q.branches);
  r.text("pixel_mode", name(q.pixel_mode));
  r.text("direction_sampling", name(q.direction_sampling));
  r.integer("emitter_sampling", q.emitter_sampling ? 1 : 0);
  // Left out where they are the defaults: digests of requests stay those that older versions stored.
  if (q.sampler != JobRequest{}.sampler) r.text("sampler", name(q.sampler));
  if (q.effects != JobRequest{}.effects) r.text("effects", q.effects);
  if (q.adaptive) r.integer("adaptive", 1);
  if (q.filter != JobRequest{}.filter) r.text("filter", name(q.filter));
  if (q.emitter_choice != JobRequest{}.emitter_choice) r.text("emitter_choice", name(q.emitter_choice));
  if (q.texture_filter != JobRequest{}.texture_filter) r.text("texture_filter", name(q.texture_filter));
  if (!q.layers.empty()) r.text("layers", q.layers);
  write_lens_and_crop(r, q);
  write_tree_budget(r, q.tree);
  if (q.reuse) r.integer("reuse", 1);
}

JobRequest read_request(const RecordReader& r) {
  JobRequest q;
  q.name = r.text("name");
  q.scene = r.text("scene");
  q.camera = read_camera(r);
  q.width = static_cast<int>(r.integer("width", q.width));
  q.height = static_cast<int>(r.integer("height", q.height));
  q.stop.samples = r.natural("stop.samples", q.stop.samples);
  if (r.has("stop.seconds")) q.stop.seconds = r.real("stop.seconds");
  if (r.has("stop.error")) q.stop.error = r.real("stop.error");
  q.stop.tile_samples = naturals(r.list("stop.tile_samples"));
  q.light_model = light_model_named(r.text("light_model")).value_or(q.light_model);
  q.light_model_overrides = overrides_of(r.text("light_model_overrides")).value_or(LightModelOverrides{});
  q.max_depth = static_cast<int>(r.integer("max_depth", depth_limit(q)));
  q.seed = r.natural("seed", q.seed);
  q.tile = static_cast<int>(r.integer("tile", q.tile));
  q.priority = static_cast<int>(r.integer("priority", q.priority));
  q.branches = static_cast<int>(r.integer("branches", q.branches));
  q.pixel_mode = pixel_mode_named(r.text("pixel_mode")).value_or(q.pixel_mode);
  q.direction_sampling =
      direction_sampling_named(r.text("direction_sampling")).value_or(q.direction_sampling);
  q.emitter_sampling = r.integer("emitter_sampling", 1) != 0;
  q.sampler = sampler_named(r.text("sampler")).value_or(q.sampler);
  q.effects = r.text("effects", q.effects);
  q.adaptive = r.integer("adaptive") != 0;
  q.filter = filter_named(r.text("filter")).value_or(q.filter);
  q.emitter_choice = emitter_choice_named(r.text("emitter_choice")).value_or(q.emitter_choice);
  q.texture_filter = texture_filter_named(r.text("texture_filter")).value_or(q.texture_filter);
  q.layers = r.text("layers");
  read_lens_and_crop(r, q);
  q.tree = read_tree_budget(r);
  q.reuse = r.integer("reuse") != 0;
  return q;
}

std::string_view name(PrepareStage stage) {
  switch (stage) {
    case PrepareStage::kWaiting: return "waiting";
    case PrepareStage::kImporting: return "importing";
    case PrepareStage::kBuilding: return "building";
    case PrepareStage::kNone: break;
  }
  return "";
}

std::string encode_job(const JobSnapshot& job) {
  RecordWriter r;
  r.text("id", job.id);
  write_request(r, job.request);
  r.text("state", name(job.state));
  r.natural("revision", job.revision);
  r.natural("image_revision", job.image_revision);
  r.integer("created", to_micros(job.created));
  if (job.started) r.integer("started", to_micros(*job.started));
  if (job.finished) r.integer("finished", to_micros(*job.finished));
  r.real("elapsed_seconds", job.elapsed_seconds);
  write_progress(r, job.progress);
  write_statistics(r, job.statistics);
  write_accuracy(r, job);
  write_effects(r, job.effects);
  for (const JobWarning& warning : job.warnings) {
    r.text("warning.code", warning.code);
    r.text("warning.message", warning.message);
    r.text("warning.where", warning.where);
  }
  if (job.error) write_error(r, *job.error);
  return r.str();
}

std::optional<JobSnapshot> decode_job(std::string_view text) {
  const auto parsed = RecordReader::parse(text);
  if (!parsed) return std::nullopt;
  const RecordReader& r = *parsed;
  const auto state = job_state_named(r.text("state"));
  if (!state || r.text("id").empty()) return std::nullopt;
  JobSnapshot job;
  job.id = r.text("id");
  job.request = read_request(r);
  job.state = *state;
  job.revision = r.natural("revision", 1);
  job.image_revision = r.natural("image_revision");
  job.created = from_micros(r.integer("created"));
  job.started = read_time(r, "started");
  job.finished = read_time(r, "finished");
  job.elapsed_seconds = r.real("elapsed_seconds");
  job.progress = read_progress(r);
  job.statistics = read_statistics(r);
  read_accuracy(r, job);
  job.effects = read_effects(r);
  for (std::size_t i = 0; i < r.list("warning.code").size(); ++i) {
    job.warnings.push_back({text_at(r.list("warning.code"), i), text_at(r.list("warning.message"), i),
                            text_at(r.list("warning.where"), i)});
  }
  job.error = read_error(r);
  return job;
}

}  // namespace raykiln::server
