// Strict reading of JSON objects: every deviation becomes a FieldError with its pointer.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "raykiln/api/problem.hpp"

namespace raykiln::server {

inline constexpr std::size_t kMaxFieldErrors = 32;

/// One JSON value, keys unique (`duplicates` takes the pointers of those that are not), at most 16
/// levels deep; or why the text is none.
[[nodiscard]] std::variant<nlohmann::json, Problem> parse_json(std::string_view text,
                                                               std::vector<FieldError>& duplicates);

/// Reads the fields of one object. A field that is absent gives nothing, and an error if required.
class FieldReader {
 public:
  FieldReader(const nlohmann::json& object, std::string pointer, std::vector<FieldError>& errors);

  enum class Need { kOptional, kRequired };
  struct Bounds {
    std::uint64_t least, most;
  };
  [[nodiscard]] std::optional<std::uint64_t> natural(const char* name, Bounds bounds,
                                                     Need need = Need::kOptional);
  [[nodiscard]] std::optional<bool> boolean(const char* name);
  /// UTF-8 without control characters, `least` to `most` bytes.
  [[nodiscard]] std::optional<std::string> text(const char* name, Bounds bytes,
                                                Need need = Need::kOptional);
  /// A finite number.
  [[nodiscard]] std::optional<double> number(const char* name);
  [[nodiscard]] std::optional<std::vector<double>> numbers(const char* name, std::size_t count,
                                                           Need need = Need::kOptional);
  /// The value itself, of any type.
  [[nodiscard]] const nlohmann::json* any(const char* name, Need need = Need::kOptional);

  /// Reports the fields that nobody has asked for.
  void finish();

  void error(std::string_view name, std::string code, std::string detail);
  [[nodiscard]] std::string pointer_to(std::string_view name) const;

 private:
  const nlohmann::json& object_;
  std::string pointer_;
  std::vector<FieldError>& errors_;
  std::vector<std::string> known_;
};

/// What is wrong with the fields of a body, all of it. Precondition: something is.
[[nodiscard]] Problem problem_of_fields(std::vector<FieldError> errors);

/// Reads the body as an object by `read(FieldReader&, errors, value)`; the problem tells all that is wrong with it.
template <class Value, class Read>
std::variant<Value, Problem> parse_object(std::string_view body, Read read) {
  std::vector<FieldError> errors;
  auto parsed = parse_json(body, errors);
  if (auto* problem = std::get_if<Problem>(&parsed)) return *problem;
  const auto& object = std::get<nlohmann::json>(parsed);
  Value result;
  if (object.is_object()) {
    FieldReader reader(object, "", errors);
    read(reader, errors, result);
    reader.finish();
  } else {
    errors.push_back({"", "wrong_type", "must be an object"});
  }
  if (errors.empty()) return result;
  return problem_of_fields(std::move(errors));
}

}  // namespace raykiln::server
