#include "raykiln/jobs/effect_report.hpp"

#include <algorithm>

namespace raykiln::server {

bool is_approximation(const EffectReport& report) {
  return std::any_of(report.lines.begin(), report.lines.end(), [](const EffectLine& line) {
    return line.called_for && !line.simulated;
  });
}

std::string approximation_note(const EffectReport& report) {
  return is_approximation(report) ? "Deliberate approximation: effects " + report.label : "";
}

std::string simulated_names(const EffectReport& report) {
  std::string names;
  for (const EffectLine& line : report.lines) {
    if (!line.simulated) continue;
    names += names.empty() ? "" : ",";
    names += line.name;
  }
  return names;
}

void write_effects(RecordWriter& record, const EffectReport& report) {
  if (report.lines.empty()) return;
  record.text("effects.label", report.label);
  for (const EffectLine& line : report.lines) {
    record.text("effect.name", line.name);
    record.integer("effect.called_for", line.called_for ? 1 : 0);
    record.integer("effect.simulated", line.simulated ? 1 : 0);
    record.text("effect.evidence", line.evidence);
    record.text("effect.grade", line.grade);
    record.text("effect.left_out", line.left_out);
  }
}

EffectReport read_effects(const RecordReader& record) {
  EffectReport report;
  report.label = record.text("effects.label");
  const auto at = [&](const char* key, std::size_t i) {
    const auto& list = record.list(key);
    return i < list.size() ? list[i] : std::string();
  };
  for (std::size_t i = 0; i < record.list("effect.name").size(); ++i) {
    report.lines.push_back({.name = at("effect.name", i),
                            .called_for = at("effect.called_for", i) == "1",
                            .simulated = at("effect.simulated", i) == "1",
                            .evidence = at("effect.evidence", i),
                            .grade = at("effect.grade", i),
                            .left_out = at("effect.left_out", i)});
  }
  return report;
}

}  // namespace raykiln::server
