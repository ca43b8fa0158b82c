// What is questionable about a scene: one report of findings with a level each. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/io/import.hpp"

namespace raykiln::render {

enum class LintLevel : std::uint8_t {
  kError,    ///< the picture will not show what the scene means
  kWarning,  ///< something was left out, or is close to what floats can tell apart
  kNote,     ///< a choice that the import made
};
[[nodiscard]] std::string_view name(LintLevel level);

struct LintFinding {
  LintLevel level = LintLevel::kNote;
  std::string code;          ///< stable, snake_case
  std::string message;       ///< for people
  std::string where;         ///< file and line, material or triangle; may be empty
  std::uint64_t count = 1;   ///< occurrences
};

/// Errors first, then warnings, then notes. Beside the warnings of the import: slivers, edges near
/// the resolution of their coordinates, bodies of glass that are open, turned inside out or wound
/// in two ways, and emitters without area.
[[nodiscard]] std::vector<LintFinding> lint(const ImportedScene& imported);

/// The one finding of a scene that was refused.
[[nodiscard]] LintFinding lint(const ImportError& error);

}  // namespace raykiln::render
