#include <algorithm>
#include <iostream>

#include "json_text.hpp"
#include "load_here.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/lint/lint.hpp"

namespace raykiln::server {
namespace {

using render::LintFinding;
using render::LintLevel;

LintFinding as_finding(const Error& error) {
  return {LintLevel::kError, error.code, error.message, error.where, 1};
}

std::vector<LintFinding> findings_of(const std::filesystem::path& scene) {
  const auto imported = import_here(scene);
  if (!imported) return {as_finding(imported.error())};
  if (const auto* refused = std::get_if<render::ImportError>(&*imported)) return {lint(*refused)};
  return lint(std::get<render::ImportedScene>(*imported));
}

void print(const LintFinding& finding) {
  std::cout << name(finding.level) << ": " << finding.message;
  if (finding.count > 1) std::cout << " (" << finding.count << " times)";
  if (!finding.where.empty()) std::cout << " [" << finding.where << ']';
  std::cout << " {" << finding.code << "}\n";
}

std::string json(const LintFinding& finding) {
  return "{\"level\":" + json_string(name(finding.level)) + ",\"code\":" + json_string(finding.code) +
         ",\"message\":" + json_string(finding.message) + ",\"where\":" + json_string(finding.where) +
         ",\"count\":" + std::to_string(finding.count) + "}";
}

}  // namespace

ExitCode lint_command(const CliOptions& options) {
  const auto findings = findings_of(options.scene);
  const auto of_level = [&](LintLevel level) {
    return std::count_if(findings.begin(), findings.end(),
                         [level](const LintFinding& f) { return f.level == level; });
  };
  const auto errors = of_level(LintLevel::kError), warnings = of_level(LintLevel::kWarning);
  if (options.json) {
    std::cout << "{\"errors\":" << errors << ",\"warnings\":" << warnings
              << ",\"notes\":" << of_level(LintLevel::kNote) << ",\"findings\":[";
    for (std::size_t i = 0; i < findings.size(); ++i) std::cout << (i > 0 ? "," : "") << json(findings[i]);
    std::cout << "]}\n";
  } else {
    for (const LintFinding& finding : findings) print(finding);
    std::cout << errors << " errors, " << warnings << " warnings, " << of_level(LintLevel::kNote)
              << " notes\n";
  }
  return errors == 0 ? ExitCode::kOk : ExitCode::kCheckFailed;
}

}  // namespace raykiln::server
