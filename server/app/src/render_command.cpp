#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "accuracy_line.hpp"
#include "output_file.hpp"
#include "raykiln/api/job_json.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/app/local_render.hpp"
#include "raykiln/image/encode.hpp"
#include "raykiln/scheduler/layers.hpp"

namespace raykiln::server {
namespace {

ExitCode complain(const Error& error) {
  std::cerr << "raykiln: " << error.message;
  if (!error.where.empty()) std::cerr << " (" << error.where << ')';
  std::cerr << " [" << error.code << "]\n";
  if (error.kind == ErrorKind::kInternal) return ExitCode::kFailure;
  if (error.code == "invalid_request") return ExitCode::kUsage;
  if (error.code == "tree_too_large") return ExitCode::kJobFailed;
  return ExitCode::kScene;
}

std::map<std::string, std::string> attributes(const LocalPicture& picture, const std::string& scene) {
  const JobSnapshot& job = picture.job;
  std::map<std::string, std::string> written{{"raykiln:scene", scene},
          {"raykiln:adaptive", job.request.adaptive ? "true" : "false"},
          {"raykiln:light_model", light_model_label(job.request.light_model, job.request.light_model_overrides)},
          {"raykiln:seed", std::to_string(job.request.seed)},
          {"raykiln:sampler", std::string(name(job.request.sampler))},
          {"raykiln:samples", std::to_string(job.progress.samples_per_pixel)},
          {"raykiln:max_depth", std::to_string(depth_limit(job.request))},
          {"raykiln:effects", job.effects.label},
          {"raykiln:simulated", simulated_names(job.effects)},
          {"raykiln:seconds", std::to_string(job.elapsed_seconds)},
          {"raykiln:version", RAYKILN_VERSION}};
  if (!job.request.layers.empty()) written["raykiln:layers"] = job.request.layers;
  return written;
}

std::vector<render::ExtraPlane> planes_of(const LocalPicture& picture) {
  std::vector<render::ExtraPlane> planes{{"error", picture.error}, {"samples", picture.samples}};
  for (const StoredLayer& layer : picture.layers) planes.push_back(exr_plane(layer));
  return planes;
}

std::variant<render::Bytes, render::EncodeError> exr(const CliOptions& options,
                                                     const LocalPicture& picture,
                                                     const std::string& scene,
                                                     const std::filesystem::path& output) {
  auto written = attributes(picture, scene);
  if (!options.picture.half) {
    return render::encode_exr(picture.image, written, planes_of(picture));
  }
  const auto range = render::half_range(picture.image);
  written["raykiln:clamped_values"] = std::to_string(range.clamped);
  written["raykiln:vanished_values"] = std::to_string(range.vanished);
  if (range.clamped > 0) say_clamped(output, std::to_string(range.clamped));
  auto encoded = render::encode_half_exr(picture.image, written);
  if (const auto* error = std::get_if<render::EncodeError>(&encoded)) return *error;
  return std::move(std::get<render::HalfExr>(encoded).bytes);
}

/// Samples that are not in the picture, and how to look at one of them.
void say_bad_samples(const CliOptions& options, const JobStatistics& statistics) {
  if (statistics.non_finite == 0) return;
  std::cerr << "warning: " << statistics.non_finite
            << " samples were not finite and are not in the picture\n";
  for (const auto& bad : statistics.bad_samples) {
    std::cerr << "  raykiln replay " << options.scene.string() << ' ' << bad.x << ' ' << bad.y << ' '
              << bad.sample << " (with the options of this picture)\n";
  }
}

/// Where a budget was asked for: what the tree came to.
void say_tree(const JobSnapshot& job) {
  const auto& tree = job.statistics.tree;
  if (job.request.tree == TreeBudget{} || !tree) return;
  std::cerr << "tree: " << tree->references << " references, " << tree->bytes << " bytes, " << tree->peak_bytes
            << " while it was built"
            << (tree->budget_reached ? "; a bound stopped at least one useful split, the picture is exact" : "") << '\n';
}

ExitCode write_pictures(const CliOptions& options, const LocalPicture& picture,
                        const std::string& scene) {
  for (const auto& output : options.outputs) {
    const auto encoded = output.extension() == ".png"
                             ? render::encode_png(picture.image, options.picture.exposure_stops,
                                                  approximation_note(picture.job.effects))
                             : exr(options, picture, scene, output);
    std::optional<std::string> error;
    if (const auto* failure = std::get_if<render::EncodeError>(&encoded)) {
      error = failure->message;
    } else {
      const auto& bytes = std::get<render::Bytes>(encoded);
      const std::string text(bytes.begin(), bytes.end());
      error = write_whole_file(output, text);
    }
    if (!error) continue;
    std::cerr << "raykiln: " << *error << '\n';
    return ExitCode::kFailure;
  }
  return ExitCode::kOk;
}

}  // namespace

Result<std::vector<std::uint8_t>> local_exr(const LocalPicture& picture, const std::string& scene) {
  auto encoded = render::encode_exr(picture.image, attributes(picture, scene), planes_of(picture));
  if (const auto* failure = std::get_if<render::EncodeError>(&encoded)) {
    return Error{ErrorKind::kInternal, "internal", failure->message, ""};
  }
  return std::get<render::Bytes>(std::move(encoded));
}

ExitCode render_command(const CliOptions& options) {
  render::set_image_library_threads(1);
  auto package = find_scene_files(options.scene);
  if (!package) return complain(package.error());
  package->allow_missing = options.allow_missing;
  const auto scene = scene_id(*package);
  if (!scene) return complain(scene.error());
  JobRequest request = options.picture.request;
  request.scene = *scene;
  if (const auto valid = validate(request, JobLimits{}); !valid) return complain(valid.error());

  WorkerSettings workers;
  workers.threads = options.threads;
  LocalPool pool(workers);
  ProgressLine line(std::cerr, isatty(STDERR_FILENO) != 0, options.quiet);
  auto picture = render_locally(*package, request, pool,
                                [&line](const ProgressState& state) { line.show(state); });
  line.finish();
  if (!picture) return complain(picture.error());
  if (!options.quiet) {
    for (const auto& warning : picture->job.warnings) {
      std::cerr << "warning: " << warning.message;
      if (!warning.where.empty()) std::cerr << " (" << warning.where << ')';
      std::cerr << '\n';
    }
  }
  if (!options.quiet) std::cerr << accuracy_line(picture->job) << '\n';
  if (!options.quiet) say_tree(picture->job);
  if (!options.quiet) say_bad_samples(options, picture->job.statistics);
  const auto code = write_pictures(options, *picture, *scene);
  if (options.json && code == ExitCode::kOk) std::cout << job_json(picture->job) << '\n';
  return code;
}

}  // namespace raykiln::server
