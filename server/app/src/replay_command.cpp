#include <cstdio>
#include <iostream>
#include <thread>

#include "raykiln/api/replay_json.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/base/ids.hpp"
#include "raykiln/render/replay.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/scene_tree.hpp"
#include "load_here.hpp"
#include "remote.hpp"

namespace raykiln::server {
namespace {

constexpr int kMostWaits = 600;  ///< a second each, for a scene that is being made ready

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

void print(const ReplayView& sample, bool as_json) {
  if (as_json) {
    std::cout << replay_json(sample) << '\n';
    return;
  }
  const auto& [r, g, b] = sample.radiance;
  std::cout << "pixel (" << sample.x << ", " << sample.y << "), sample " << sample.sample
            << ": radiance " << number(r) << ' ' << number(g) << ' ' << number(b)
            << (sample.dropped ? ", dropped: not finite" : "")
            << (sample.truncated ? ", cut at the path limit" : "") << "; " << sample.bounce_rays
            << " rays after the first, " << sample.shadow_rays << " shadow rays; effects: "
            << sample.effects << '\n';
}

ExitCode complain(const Error& error) {
  std::cerr << "raykiln: " << error.message << " [" << error.code << "]\n";
  if (error.code == "tree_too_large") return ExitCode::kJobFailed;
  return error.code == "invalid_request" ? ExitCode::kUsage : ExitCode::kScene;
}

/// A job's id, unless a file of this name says otherwise.
bool names_a_job(const CliOptions& options) {
  const std::string text = options.scene.string();
  std::error_code ignored;  // what cannot be looked at is no scene
  return text.starts_with("j_") && is_plain_id(text, 64) && !std::filesystem::exists(text, ignored);
}

bool has_code(const ClientResponse& problem, const std::string& code) {
  return problem.body.find('"' + code + '"') != std::string::npos;
}

/// The sample as the job's server renders it.
ExitCode replay_of_job(const CliOptions& options) {
  auto remote = Remote::open(options);
  if (!remote) return ExitCode::kUsage;
  const ReplayPlace& at = options.replay;
  const std::string target = "/v1/jobs/" + options.scene.string() + "/samples?x=" +
                             std::to_string(at.x) + "&y=" + std::to_string(at.y) +
                             "&sample=" + std::to_string(at.sample);
  for (int attempt = 0;; ++attempt) {
    auto answer = HttpClient(remote->address()).request("GET", target);
    if (answer && answer->status == 503 && attempt < kMostWaits && has_code(*answer, "scene_not_ready")) {
      std::this_thread::sleep_for(std::chrono::seconds(1));  // it reads the scene, builds its tree
      continue;
    }
    const bool too_large = answer && answer->status >= 400 && has_code(*answer, "tree_too_large");
    const auto response = remote->check(std::move(answer));
    if (!response) return too_large ? ExitCode::kJobFailed : remote->failure();  // as it is without a server
    const auto sample = parse_replay(response->body);
    if (!sample) return remote->fail(ExitCode::kFailure, "the server's answer is no sample");
    print(*sample, options.json);
    return ExitCode::kOk;
  }
}

/// The sample as this program renders it.
ExitCode replay_of_scene(const CliOptions& options) {
  const auto loaded = load_here(options.scene, options.allow_missing);
  if (!loaded) return complain(loaded.error());
  const JobRequest& request = options.picture.request;
  const auto settings = render_settings(request, *loaded->scene);
  if (!settings) return complain(settings.error());
  const ReplayPlace& at = options.replay;
  if (at.x >= settings->width || at.y >= settings->height) {
    return complain({ErrorKind::kInvalid, "invalid_request", "the pixel lies outside the picture", ""});
  }
  if (auto fits = check_tree_budget(*loaded->scene, request.tree); !fits) return complain(fits.error());
  render::SerialTaskRunner runner;
  const TreeBudget budget = settled_budget(*loaded->scene, request.tree, WorkerSettings().wide_tree_bytes);
  const auto scene = render::prepare(loaded->scene, build_tree(*loaded->scene, budget, runner));
  const auto replayed = render::replay_sample(*scene, *settings, at.x, at.y, at.sample);
  ReplayView view{at.x, at.y, at.sample, {replayed.radiance.x, replayed.radiance.y, replayed.radiance.z},
                  replayed.dropped, replayed.truncated, replayed.stats.bounce_rays,
                  replayed.stats.shadow_rays,
                  light_model_label(request.light_model, request.light_model_overrides), request.seed,
                  render::effects_label(render::effect_plan(*settings, *scene))};
  print(view, options.json);
  return ExitCode::kOk;
}

}  // namespace

ExitCode replay_command(const CliOptions& options) {
  return names_a_job(options) ? replay_of_job(options) : replay_of_scene(options);
}

}  // namespace raykiln::server
