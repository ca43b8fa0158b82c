#include "raykiln/lint/lint.hpp"

#include <algorithm>

#include "checks.hpp"

namespace raykiln::render {
namespace {

/// How bad it is that the import went on in this way.
LintLevel level_of(ImportWarningCode code) {
  switch (code) {
    case ImportWarningCode::kMissingMaterialFile:
    case ImportWarningCode::kNotConserving:
      return LintLevel::kError;
    case ImportWarningCode::kUnknownMaterial:
    case ImportWarningCode::kBadPolygon:
    case ImportWarningCode::kZeroAreaTriangles:
    case ImportWarningCode::kCollapsedTriangles:
    case ImportWarningCode::kCoarseCoordinates:
    case ImportWarningCode::kClampedValue:
    case ImportWarningCode::kNoLight:
    case ImportWarningCode::kZeroLight:
    case ImportWarningCode::kInvalidNormal:
    case ImportWarningCode::kMoreWarnings:
      return LintLevel::kWarning;
    default:
      return LintLevel::kNote;
  }
}

std::string place(const std::string& file, const std::string& where) {
  return file.empty() || where.empty() ? file + where : file + ", " + where;
}

std::vector<bool> used_materials(const Scene& scene) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const std::uint32_t id : scene.mesh.material_ids) used[id] = true;
  return used;
}

// By an alpha of 0, or one below the cutoff of a mask.
void check_coverage(const Scene& scene, Findings& findings) {
  const std::vector<bool> used = used_materials(scene);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i] || scene.materials[i].coverage > 0.0F) continue;
    findings.push_back({LintLevel::kWarning, "invisible_surface", "a material's alpha leaves nothing of its surfaces",
                        "material \"" + scene.materials[i].name + '"', 1});
  }
}

// Its triangles were dropped, or there never were any: it cannot shine.
void check_emitters(const Scene& scene, Findings& findings) {
  const std::vector<bool> used = used_materials(scene);
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] || scene.materials[i].emission == Rgb(0.0F)) continue;
    findings.push_back({LintLevel::kWarning, "emitter_without_area",
                        "a material emits light, but no triangle with an area has it",
                        "material \"" + scene.materials[i].name + '"', 1});
  }
}

}  // namespace

std::string_view name(LintLevel level) {
  switch (level) {
    case LintLevel::kError: return "error";
    case LintLevel::kWarning: return "warning";
    case LintLevel::kNote: break;
  }
  return "note";
}

std::vector<LintFinding> lint(const ImportedScene& imported) {
  Findings findings;
  for (const ImportWarning& w : imported.report.warnings) {
    findings.push_back({level_of(w.code), std::string(name(w.code)), w.message,
                        place(w.file, w.where), w.count});
  }
  check_shapes(imported.scene, findings);
  check_glass(imported.scene, findings);
  check_emitters(imported.scene, findings);
  check_coverage(imported.scene, findings);
  std::stable_sort(findings.begin(), findings.end(),
                   [](const auto& a, const auto& b) { return a.level < b.level; });
  return findings;
}

LintFinding lint(const ImportError& error) {
  std::string message = error.message;
  if (!error.remedy.empty()) message += "; " + error.remedy;
  return {LintLevel::kError, std::string(name(error.code)), message, place(error.file, error.where), 1};
}

}  // namespace raykiln::render
