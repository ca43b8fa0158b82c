// Statements of a text file, one at a time, from a stream: the file is never whole in memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics.hpp"

namespace raykiln::render::io {

/// A statement is a line, or several joined by a backslash at their ends. LF, CRLF and CR-less last
/// lines are understood; a UTF-8 mark is skipped, UTF-16 refused.
class LineReader {
 public:
  LineReader(SceneFile& file, std::string name, Diagnostics& diagnostics);

  /// False at the end and after a failure. `statement` is valid until the next call.
  bool next(std::string_view& statement);
  /// Number of the first line of the statement, from 1.
  [[nodiscard]] std::uint64_t line() const { return first_line_; }
  [[nodiscard]] const std::string& file_name() const { return name_; }
  bool fail(ImportErrorCode code, std::string_view message, std::string_view remedy = {});

 private:
  bool physical_line(std::string_view& line);
  bool refill();
  bool check_encoding();

  SceneFile* file_;
  std::string name_;
  Diagnostics* diagnostics_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  ///< unread bytes are buffer_[begin_, end_)
  std::size_t end_ = 0;
  bool at_end_ = false;
  bool started_ = false;
  std::uint64_t lines_read_ = 0;
  std::uint64_t first_line_ = 0;
  std::string joined_;
};

}  // namespace raykiln::render::io
