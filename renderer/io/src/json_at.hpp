// A place in a JSON document, with typed reads that record an error and its JSON pointer.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics.hpp"

namespace raykiln::render::io {

class JsonAt;

/// Owns a parsed document. Nesting depth and number of values are checked before the parse.
class JsonDocument {
 public:
  /// Nothing, with the error recorded, when `text` is not one JSON value within the limits.
  static std::optional<JsonDocument> parse(std::string_view text, const std::string& file,
                                           Diagnostics& diagnostics);
  [[nodiscard]] JsonAt root() const;

 private:
  JsonDocument(std::shared_ptr<const nlohmann::json> value, std::string file,
               Diagnostics& diagnostics)
      : value_(std::move(value)), file_(std::move(file)), diagnostics_(&diagnostics) {}
  std::shared_ptr<const nlohmann::json> value_;  ///< shared: its deleter knows the type, we do not
  std::string file_;
  Diagnostics* diagnostics_;
};

/// Cheap to copy except for its pointer text; valid while the document lives and stays in place.
/// The `*_or` reads return the fallback when the field is absent, and also after recording an error
/// when it has the wrong type: ask Diagnostics::failed() before using what was read.
class JsonAt {
 public:
  JsonAt(const nlohmann::json& value, std::string pointer, const std::string& file,
         Diagnostics& diagnostics)
      : value_(&value), pointer_(std::move(pointer)), file_(&file), diagnostics_(&diagnostics) {}

  [[nodiscard]] bool is_object() const;
  [[nodiscard]] bool is_array() const;
  [[nodiscard]] const std::string& pointer() const { return pointer_; }
  [[nodiscard]] const std::string& file() const { return *file_; }
  [[nodiscard]] Diagnostics& diagnostics() const { return *diagnostics_; }

  bool fail(ImportErrorCode code, std::string_view message, std::string_view remedy = {}) const;
  void warn(ImportWarningCode code, std::string_view message) const;
  bool expect_object() const;
  bool expect_array() const;

  /// Members in order of their names (of an object), elements (of an array).
  [[nodiscard]] std::vector<std::string> keys() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool has(const char* key) const;
  [[nodiscard]] bool is_text(const char* key) const;
  [[nodiscard]] std::optional<JsonAt> find(const char* key) const;
  [[nodiscard]] JsonAt member(const std::string& key) const;
  [[nodiscard]] JsonAt element(std::size_t index) const;
  /// The array member `key`; nothing when absent, or when it is no array (recorded).
  [[nodiscard]] std::optional<JsonAt> array(const char* key) const;
  [[nodiscard]] std::optional<JsonAt> object(const char* key) const;

  [[nodiscard]] std::optional<double> number() const;
  [[nodiscard]] std::optional<std::uint64_t> integer() const;
  [[nodiscard]] std::optional<std::string> text() const;
  /// As text(), without a copy: valid while the document lives.
  [[nodiscard]] std::optional<std::string_view> text_view() const;
  /// Exactly `size` numbers.
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::size_t size) const;

  [[nodiscard]] double number_or(const char* key, double fallback) const;
  /// Also checks least <= value <= most.
  [[nodiscard]] double number_in(const char* key, double fallback, double least, double most) const;
  [[nodiscard]] std::uint64_t integer_or(const char* key, std::uint64_t fallback) const;
  [[nodiscard]] bool flag_or(const char* key, bool fallback) const;
  [[nodiscard]] std::string text_or(const char* key, std::string_view fallback) const;
  [[nodiscard]] Vec3d vec3_or(const char* key, const Vec3d& fallback) const;
  /// Three numbers in [least, most].
  [[nodiscard]] Vec3d vec3_in(const char* key, const Vec3d& fallback, double least,
                              double most) const;
  /// Fails with kUnknownField on a member that is not in `known`.
  bool only(std::initializer_list<std::string_view> known) const;

 private:
  const nlohmann::json* value_;
  std::string pointer_;
  const std::string* file_;
  Diagnostics* diagnostics_;
};

}  // namespace raykiln::render::io
