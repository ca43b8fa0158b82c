#include "json_at.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace raykiln::render::io {
namespace {

using Json = nlohmann::json;

// '~' and '/' are escaped as RFC 6901 asks.
std::string escaped(std::string_view key) {
  std::string text;
  for (const char c : key) {
    if (c == '~') {
      text += "~0";
    } else if (c == '/') {
      text += "~1";
    } else {
      text += c;
    }
  }
  return text;
}

std::uint64_t line_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte);
  return 1 + static_cast<std::uint64_t>(std::count(before.begin(), before.end(), '\n'));
}

// One pass over the bytes outside of strings: how deep they nest, and how many values they can hold
// at most. The parser allocates for each value, so both are bounded before it runs.
bool within_limits(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  const ImportLimits& limits = diagnostics.limits();
  std::size_t depth = 0;
  std::size_t values = 1;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '}' || c == ']') depth -= depth > 0 ? 1 : 0;
    if (c == ',' || c == '{' || c == '[') ++values;
    if ((c == '{' || c == '[') && ++depth > limits.max_json_depth) {
      return diagnostics.fail(ImportErrorCode::kJsonTooDeep,
                              "the JSON nests deeper than " + std::to_string(limits.max_json_depth),
                              file, line_text(line_of(text, i)));
    }
  }
  if (values <= limits.max_json_values) return true;
  return diagnostics.fail(ImportErrorCode::kLimitExceeded,
                          "the JSON has more than " + std::to_string(limits.max_json_values) +
                              " values",
                          file, "", "keep geometry in binary buffers");
}

// The parser's message ends with the number in quotes but does not say where it is: the line where
// it stands first.
std::string place_of_number(std::string_view text, std::string_view message) {
  const std::size_t close = message.rfind('\'');
  if (close == std::string_view::npos || close == 0) return "";
  const std::size_t open = message.rfind('\'', close - 1);
  if (open == std::string_view::npos) return "";
  const std::size_t at = text.find(message.substr(open + 1, close - open - 1));
  return at == std::string_view::npos ? "" : line_text(line_of(text, at));
}

}  // namespace

std::optional<JsonDocument> JsonDocument::parse(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (!within_limits(text, file, diagnostics)) return std::nullopt;
  try {
    auto value = std::make_shared<const Json>(Json::parse(text.begin(), text.end()));
    return JsonDocument(std::move(value), file, diagnostics);
  } catch (const Json::parse_error& error) {
    const std::size_t at = std::min(error.byte > 0 ? error.byte - 1 : 0, text.size());
    diagnostics.fail(ImportErrorCode::kInvalidJson,
                     "this is not JSON (byte " + std::to_string(at) + ")", file,
                     line_text(line_of(text, at)));
  } catch (const Json::exception& error) {  // a number that no double can hold
    diagnostics.fail(ImportErrorCode::kNotFinite, "a number in the JSON overflows", file,
                     place_of_number(text, error.what()));
  }
  return std::nullopt;
}

JsonAt JsonDocument::root() const { return {*value_, "", file_, *diagnostics_}; }

bool JsonAt::is_object() const { return value_->is_object(); }
bool JsonAt::is_array() const { return value_->is_array(); }

bool JsonAt::fail(ImportErrorCode code, std::string_view message, std::string_view remedy) const {
  return diagnostics_->fail(code, message, *file_, pointer_, remedy);
}

void JsonAt::warn(ImportWarningCode code, std::string_view message) const {
  diagnostics_->warn(code, message, *file_, pointer_);
}

bool JsonAt::expect_object() const {
  return is_object() || fail(ImportErrorCode::kWrongType, "an object is expected here");
}
bool JsonAt::expect_array() const {
  return is_array() || fail(ImportErrorCode::kWrongType, "an array is expected here");
}

std::vector<std::string> JsonAt::keys() const {
  std::vector<std::string> names;
  if (!is_object()) return names;
  for (auto it = value_->begin(); it != value_->end(); ++it) names.push_back(it.key());
  return names;
}

std::size_t JsonAt::size() const { return value_->is_structured() ? value_->size() : 0; }

bool JsonAt::has(const char* key) const { return is_object() && value_->contains(key); }

bool JsonAt::is_text(const char* key) const { return has(key) && value_->at(key).is_string(); }

JsonAt JsonAt::member(const std::string& key) const {
  return {value_->at(key), pointer_ + "/" + escaped(key), *file_, *diagnostics_};
}

std::optional<JsonAt> JsonAt::find(const char* key) const {
  if (!has(key)) return std::nullopt;
  return member(key);
}

JsonAt JsonAt::element(std::size_t index) const {
  return {value_->at(index), pointer_ + "/" + std::to_string(index), *file_, *diagnostics_};
}

std::optional<JsonAt> JsonAt::array(const char* key) const {
  auto found = find(key);
  if (found && !found->expect_array()) return std::nullopt;
  return found;
}

std::optional<JsonAt> JsonAt::object(const char* key) const {
  auto found = find(key);
  if (found && !found->expect_object()) return std::nullopt;
  return found;
}

std::optional<double> JsonAt::number() const {
  if (value_->is_number()) {
    const double value = value_->get<double>();
    if (std::isfinite(value)) return value;
  }
  fail(ImportErrorCode::kWrongType, "a number is expected here");
  return std::nullopt;
}

std::optional<std::uint64_t> JsonAt::integer() const {
  if (value_->is_number_unsigned()) return value_->get<std::uint64_t>();
  if (value_->is_number_float()) {  // 3.0 is an integer for JSON Schema
    const double value = value_->get<double>();
    if (value >= 0.0 && value <= 9e15 && value == std::floor(value)) {
      return static_cast<std::uint64_t>(value);
    }
  }
  fail(ImportErrorCode::kWrongType, "an integer of at least 0 is expected here");
  return std::nullopt;
}

std::optional<std::string_view> JsonAt::text_view() const {
  if (value_->is_string()) return std::string_view(value_->get_ref<const std::string&>());
  fail(ImportErrorCode::kWrongType, "a string is expected here");
  return std::nullopt;
}

std::optional<std::string> JsonAt::text() const {
  const auto view = text_view();
  if (!view) return std::nullopt;
  return std::string(*view);
}

std::optional<std::vector<double>> JsonAt::numbers(std::size_t count) const {
  if (!is_array() || value_->size() != count) {
    fail(ImportErrorCode::kWrongType,
         "an array of " + std::to_string(count) + " numbers is expected here");
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = element(i).number();
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

double JsonAt::number_or(const char* key, double fallback) const {
  const auto found = find(key);
  return found ? found->number().value_or(fallback) : fallback;
}

double JsonAt::number_in(const char* key, double fallback, double least, double most) const {
  const double value = number_or(key, fallback);
  if (value >= least && value <= most) return value;
  member(key).fail(ImportErrorCode::kInvalidValue, "the number is outside of its range");
  return fallback;
}

std::uint64_t JsonAt::integer_or(const char* key, std::uint64_t fallback) const {
  const auto found = find(key);
  return found ? found->integer().value_or(fallback) : fallback;
}

bool JsonAt::flag_or(const char* key, bool fallback) const {
  if (!has(key)) return fallback;
  const JsonAt found = member(key);
  if (found.value_->is_boolean()) return found.value_->get<bool>();
  found.fail(ImportErrorCode::kWrongType, "true or false is expected here");
  return fallback;
}

std::string JsonAt::text_or(const char* key, std::string_view fallback) const {
  const auto found = find(key);
  return found ? found->text().value_or(std::string(fallback)) : std::string(fallback);
}

Vec3d JsonAt::vec3_or(const char* key, const Vec3d& fallback) const {
  const auto found = find(key);
  if (!found) return fallback;
  const auto v = found->numbers(3);
  return v ? Vec3d((*v)[0], (*v)[1], (*v)[2]) : fallback;
}

Vec3d JsonAt::vec3_in(const char* key, const Vec3d& fallback, double least, double most) const {
  const Vec3d v = vec3_or(key, fallback);
  for (int axis = 0; axis < 3; ++axis) {
    if (v[axis] >= least && v[axis] <= most) continue;
    member(key).fail(ImportErrorCode::kInvalidValue, "a component is outside of its range");
    return fallback;
  }
  return v;
}

bool JsonAt::only(std::initializer_list<std::string_view> known) const {
  for (const std::string& key : keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const std::string_view one : known) names += (names.empty() ? "" : ", ") + std::string(one);
    return member(key).fail(ImportErrorCode::kUnknownField, "there is no field " + in_quotes(key),
                            "known fields here: " + names);
  }
  return true;
}

}  // namespace raykiln::render::io
