#include <iomanip>
#include <iostream>

#include "json_text.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/app/scene_package.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/scene_intake.hpp"
#include "scratch.hpp"

namespace raykiln::server {
namespace {

using render::EffectPlan;
using render::EffectVerdict;

ExitCode complain(const Error& error) {
  std::cerr << "raykiln: " << error.message << " [" << error.code << "]\n";
  return error.code == "invalid_request" ? ExitCode::kUsage : ExitCode::kScene;
}

const char* word(const EffectVerdict& v) {
  if (v.approximated()) return "LEFT OUT";
  return v.called_for ? "called for" : (v.simulated ? "simulated" : "-");
}

void print(const EffectPlan& plan) {
  for (const EffectVerdict& v : plan.verdicts) {
    const render::EffectRow& row = render::row_of(v.effect);
    std::cout << std::left << std::setw(21) << row.name << std::setw(11) << word(v) << v.evidence << '\n';
    if (v.simulated) continue;
    std::cout << std::setw(32) << "" << "left out ("
              << name(v.called_for ? row.forced : row.grade) << "): " << row.left_out << '\n';
  }
  std::cout << "effects: " << effects_label(plan) << '\n';
}

std::string json(const EffectVerdict& v) {
  const render::EffectRow& row = render::row_of(v.effect);
  const auto truth = [](bool value) { return value ? "true" : "false"; };
  return std::string("{\"effect\":") + json_string(row.name) + ",\"called_for\":" + truth(v.called_for) +
         ",\"simulated\":" + truth(v.simulated) + ",\"evidence\":" + json_string(v.evidence) +
         ",\"grade\":" +
         json_string(v.simulated ? "" : name(v.called_for ? row.forced : row.grade)) +
         ",\"left_out\":" + json_string(v.simulated ? "" : row.left_out) + "}";
}

void print_json(const EffectPlan& plan) {
  std::cout << "{\"label\":" << json_string(effects_label(plan)) << ",\"list\":[";
  for (std::size_t i = 0; i < plan.verdicts.size(); ++i) {
    std::cout << (i > 0 ? "," : "") << json(plan.verdicts[i]);
  }
  std::cout << "]}\n";
}

}  // namespace

ExitCode effects_command(const CliOptions& options) {
  const auto package = find_scene_files(options.scene);
  if (!package) return complain(package.error());
  const Scratch scratch;
  UploadLimits limits;
  limits.max_unpacked_bytes = UINT64_MAX;  // the user's own file
  const auto intake = make_scene_intake(
      limits, [&scratch] { return Result<std::filesystem::path>(scratch.path()); });
  const auto loaded = intake->load(package->kind, package->files, {});
  if (!loaded) return complain(loaded.error());
  auto settings = render_settings(options.picture.request, *loaded->scene);
  if (!settings) return complain(settings.error());
  settings->effects = options.picture.effects;
  const EffectPlan plan = render::effect_plan(*settings, *loaded->scene);
  if (options.json) {
    print_json(plan);
  } else {
    print(plan);
  }
  return ExitCode::kOk;
}

}  // namespace raykiln::server
