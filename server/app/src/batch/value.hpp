// A YAML or JSON document as a tree of plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// Scalars keep their text; what it means is decided by who asks, with the rules of JSON: true, false,
/// null and JSON's numbers are those, all other plain text is a string (`no` and `012` too).
struct Value {
  enum class Kind : std::uint8_t { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  std::string text;
  bool quoted = false;
  std::vector<Value> list;
  std::vector<std::pair<std::string, Value>> map;  ///< in the order of the file
  int line = 0;                                    ///< from 1

  [[nodiscard]] bool is_text() const { return kind == Kind::kScalar; }
  /// Null when there is none.
  [[nodiscard]] const Value* find(std::string_view key) const;
  /// Replaces or appends.
  void set(const std::string& key, Value value);
};

[[nodiscard]] Value text_value(std::string text);

/// How large a document may be: a batch file, unless said otherwise.
struct DocumentBounds {
  std::size_t bytes = std::size_t{1} << 20U;
  int nodes = 100'000;  ///< however often an alias repeats them
};

/// Reads YAML 1.2 (JSON is that too), at most 64 levels deep, aliases written out in at most 4 times the bytes.
/// kInvalid "invalid_file" with the line in `where`.
[[nodiscard]] Result<Value> parse_yaml(std::string_view text, const DocumentBounds& bounds = {});

/// The same value as JSON text.
[[nodiscard]] std::string to_json(const Value& value);

}  // namespace raykiln::server
