// Numbers and words of a statement, without locale.
#pragma once

#include <cstdint>
#include <string_view>

namespace raykiln::render::io {

enum class NumberStatus { kOk, kMissing, kMalformed, kNotFinite };

/// Drops spaces, tabs and stray carriage returns from the front.
void skip_spaces(std::string_view& text);
/// Takes the next word, empty at the end.
[[nodiscard]] std::string_view take_word(std::string_view& text);
/// Takes the next decimal number. A magnitude too small for double is 0; infinities, NaN and what is
/// too large are kNotFinite.
[[nodiscard]] NumberStatus take_number(std::string_view& text, double& value);
/// Takes an integer from the front of `text` (no spaces skipped); false when there is none.
[[nodiscard]] bool take_integer(std::string_view& text, std::int64_t& value);
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace raykiln::render::io
