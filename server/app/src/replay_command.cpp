#include <cmath>
#include <cstdio>
#include <iostream>

#include "json_text.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/app/scene_package.hpp"
#include "raykiln/render/replay.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/scene_intake.hpp"
#include "scratch.hpp"

namespace raykiln::server {
namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/// JSON has no word for what is not finite: such a channel is a string.
std::string json_number(double value) {
  return std::isfinite(value) ? number(value) : json_string(number(value));
}

void print(const ReplayPlace& at, const render::ReplayedSample& sample, bool as_json) {
  const auto& c = sample.radiance;
  if (as_json) {
    std::cout << "{\"x\":" << at.x << ",\"y\":" << at.y << ",\"sample\":" << at.sample
              << ",\"radiance\":[" << json_number(c.x) << ',' << json_number(c.y) << ','
              << json_number(c.z) << "],\"dropped\":" << (sample.dropped ? "true" : "false")
              << ",\"truncated\":" << (sample.truncated ? "true" : "false")
              << ",\"bounce_rays\":" << sample.stats.bounce_rays
              << ",\"shadow_rays\":" << sample.stats.shadow_rays << "}\n";
    return;
  }
  std::cout << "pixel (" << at.x << ", " << at.y << "), sample " << at.sample << ": radiance "
            << number(c.x) << ' ' << number(c.y) << ' ' << number(c.z)
            << (sample.dropped ? ", dropped: not finite" : "")
            << (sample.truncated ? ", cut at the path limit" : "") << "; "
            << sample.stats.bounce_rays << " rays after the first, " << sample.stats.shadow_rays
            << " shadow rays\n";
}

ExitCode complain(const Error& error) {
  std::cerr << "raykiln: " << error.message << " [" << error.code << "]\n";
  return error.code == "invalid_request" ? ExitCode::kUsage : ExitCode::kScene;
}

}  // namespace

ExitCode replay_command(const CliOptions& options) {
  const auto package = find_scene_files(options.scene);
  if (!package) return complain(package.error());
  const Scratch scratch;
  UploadLimits limits;
  limits.max_unpacked_bytes = UINT64_MAX;  // the user's own file
  const auto intake = make_scene_intake(
      limits, [&scratch] { return Result<std::filesystem::path>(scratch.path()); });
  const auto loaded = intake->load(package->kind, package->files, {});
  if (!loaded) return complain(loaded.error());
  const auto settings = render_settings(options.picture.request, *loaded->scene);
  if (!settings) return complain(settings.error());
  const ReplayPlace& at = options.replay;
  if (at.x >= settings->width || at.y >= settings->height) {
    return complain({ErrorKind::kInvalid, "invalid_request", "the pixel lies outside the picture", ""});
  }
  render::SerialTaskRunner runner;
  const auto scene = render::prepare(loaded->scene, render::build_scene_tree(*loaded->scene, {}, runner));
  print(at, render::replay_sample(*scene, *settings, at.x, at.y, at.sample), options.json);
  return ExitCode::kOk;
}

}  // namespace raykiln::server
