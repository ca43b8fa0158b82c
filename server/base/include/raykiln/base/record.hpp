// A small text record: lines "key value", values escaped. What the store keeps as opaque text.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raykiln::server {

/// Order of insertion is kept; a key may occur several times (a list).
class RecordWriter {
 public:
  void text(std::string_view key, std::string_view value);
  void integer(std::string_view key, std::int64_t value);
  void natural(std::string_view key, std::uint64_t value);
  void real(std::string_view key, double value);  ///< shortest form that reads back exactly
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_;
};

/// Unknown keys are ignored by readers, missing ones give the fallback, so that records of an older
/// version still read.
class RecordReader {
 public:
  /// Nothing when the text is not a record.
  [[nodiscard]] static std::optional<RecordReader> parse(std::string_view text);
  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback = {}) const;
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t fallback = 0) const;
  [[nodiscard]] std::uint64_t natural(std::string_view key, std::uint64_t fallback = 0) const;
  [[nodiscard]] double real(std::string_view key, double fallback = 0.0) const;
  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] const std::vector<std::string>& list(std::string_view key) const;

 private:
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
};

}  // namespace raykiln::server
