// What went wrong while importing: at most one error, and a bounded list of warnings.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "raykiln/io/import.hpp"

namespace raykiln::render::io {

/// Valid UTF-8 without control characters, at most `max_bytes`; what is not becomes '?'.
[[nodiscard]] std::string clean_text(std::string_view raw, std::size_t max_bytes = 160);

/// The first failure wins and stays: readers return false and go on returning false.
class Diagnostics {
 public:
  explicit Diagnostics(const ImportOptions& options) : options_(&options) {}

  /// Records the error unless there is one already. Always false, so `return fail(...)` reads well.
  bool fail(ImportErrorCode code, std::string_view message, std::string_view file = {},
            std::string_view where = {}, std::string_view remedy = {});
  /// Occurrences with equal code, message and file are one warning with a count.
  void warn(ImportWarningCode code, std::string_view message, std::string_view file = {},
            std::string_view where = {}, std::uint64_t count = 1);

  [[nodiscard]] bool failed() const { return error_.has_value(); }
  /// False after a failure, and when the caller asked to stop (which is then the failure).
  [[nodiscard]] bool may_go_on();
  [[nodiscard]] const ImportLimits& limits() const { return options_->limits; }
  [[nodiscard]] ImportError take_error() { return std::move(*error_); }
  [[nodiscard]] std::vector<ImportWarning> take_warnings();

 private:
  const ImportOptions* options_;
  std::optional<ImportError> error_;
  std::vector<ImportWarning> warnings_;
  std::map<std::tuple<ImportWarningCode, std::string, std::string>, std::size_t> index_;
  std::uint64_t not_listed_ = 0;
};

[[nodiscard]] std::string line_text(std::uint64_t line);
[[nodiscard]] std::string in_quotes(std::string_view raw);

}  // namespace raykiln::render::io
