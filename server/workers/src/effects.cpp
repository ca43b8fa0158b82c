#include "raykiln/workers/effects.hpp"

namespace raykiln::server {

EffectReport effect_report(const render::EffectPlan& plan) {
  EffectReport report;
  report.label = render::effects_label(plan);
  for (const render::EffectRow* row : render::effect_table()) {
    const auto grade = plan.grade(row->effect);
    report.lines.push_back({.name = row->name,
                            .called_for = plan.called_for.contains(row->effect),
                            .simulated = plan.simulated.contains(row->effect),
                            .evidence = plan.evidence[static_cast<std::size_t>(row->effect)],
                            .grade = grade ? std::string(render::name(*grade)) : "",
                            .left_out = grade ? row->left_out : ""});
  }
  return report;
}

}  // namespace raykiln::server
