#include <iomanip>
#include <iostream>

#include "load_here.hpp"
#include "raykiln/api/effects_json.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/scheduler/render_inputs.hpp"
#include "raykiln/workers/effects.hpp"

namespace raykiln::server {
namespace {

ExitCode complain(const Error& error) {
  std::cerr << "raykiln: " << error.message << " [" << error.code << "]\n";
  return error.code == "invalid_request" ? ExitCode::kUsage : ExitCode::kScene;
}

const char* word(const EffectLine& line) {
  if (line.called_for) return line.simulated ? "called for" : "LEFT OUT";
  return line.simulated ? "simulated" : "-";
}

void print(const EffectReport& report) {
  for (const EffectLine& line : report.lines) {
    std::cout << std::left << std::setw(21) << line.name << std::setw(11) << word(line)
              << line.evidence << '\n';
    if (line.simulated) continue;
    std::cout << std::setw(32) << "" << "left out (" << line.grade << "): " << line.left_out << '\n';
  }
  std::cout << "effects: " << report.label << '\n';
}

}  // namespace

ExitCode effects_command(const CliOptions& options) {
  const auto loaded = load_here(options.scene, options.allow_missing);
  if (!loaded) return complain(loaded.error());
  const auto settings = render_settings(options.picture.request, *loaded->scene);
  if (!settings) return complain(settings.error());
  const EffectReport report = effect_report(render::effect_plan(*settings, *loaded->scene));
  if (options.json) {
    std::cout << effect_report_json(report) << '\n';
  } else {
    print(report);
  }
  return ExitCode::kOk;
}

}  // namespace raykiln::server
