#include "json_fields.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace raykiln::server {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 16;
constexpr double kLargestExact = 9007199254740992.0;  // 2^53

std::string escape_pointer(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c == '~') out += "~0";
    else if (c == '/') out += "~1";
    else out.push_back(c);
  }
  return out;
}

void append(std::vector<FieldError>& errors, FieldError error) {
  if (errors.size() < kMaxFieldErrors) errors.push_back(std::move(error));
}

/// Watches the parser for keys that come twice and for depth.
struct KeyWatch {
  std::vector<FieldError>& duplicates;
  std::vector<std::set<std::string>> keys;
  bool too_deep = false;

  bool operator()(int depth, json::parse_event_t event, json& parsed) {
    if (depth > kMaxDepth) too_deep = true;
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end && !keys.empty()) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.empty()) {
      const auto& key = parsed.get_ref<const std::string&>();
      if (!keys.back().insert(key).second) {
        append(duplicates, {'/' + escape_pointer(key), "duplicate_field", "given twice"});
      }
    }
    return !too_deep;
  }
};

bool is_whole(const json& value) {
  if (!value.is_number_float()) return value.is_number();
  return value.get<double>() == std::floor(value.get<double>());
}

/// A JSON integer, or a number without a fraction, which JSON Schema takes as one too.
std::optional<std::uint64_t> as_natural(const json& value) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0.0 && number < kLargestExact) || number != std::floor(number)) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(number);
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7F;
  });
}

}  // namespace

std::variant<json, Problem> parse_json(std::string_view text, std::vector<FieldError>& duplicates) {
  KeyWatch watch{duplicates, {}};
  try {
    json value = json::parse(text.begin(), text.end(), std::ref(watch));
    if (watch.too_deep) return Problem{400, "invalid_json", "nested more than 16 levels deep"};
    return value;
  } catch (const json::parse_error& error) {
    return Problem{400, "invalid_json", "the body is not one JSON value",
                   "byte " + std::to_string(error.byte)};
  } catch (const json::exception&) {
    return Problem{400, "invalid_json", "a number is outside the range of double precision"};
  }
}

FieldReader::FieldReader(const json& object, std::string pointer, std::vector<FieldError>& errors)
    : object_(object), pointer_(std::move(pointer)), errors_(errors) {}

std::string FieldReader::pointer_to(std::string_view name) const {
  return pointer_ + '/' + escape_pointer(name);
}

void FieldReader::error(std::string_view name, std::string code, std::string detail) {
  append(errors_, {pointer_to(name), std::move(code), std::move(detail)});
}

const json* FieldReader::any(const char* name, Need need) {
  known_.emplace_back(name);
  const auto found = object_.find(name);
  if (found != object_.end()) return &*found;
  if (need == Need::kRequired) error(name, "missing_field", "is required");
  return nullptr;
}

std::optional<std::uint64_t> FieldReader::natural(const char* name, Bounds bounds, Need need) {
  const json* value = any(name, need);
  if (value == nullptr) return std::nullopt;
  const std::string range = "must be an integer from " + std::to_string(bounds.least) + " to " +
                            std::to_string(bounds.most);
  const auto number = as_natural(*value);
  if (!is_whole(*value)) error(name, "wrong_type", range);
  else if (!number || *number < bounds.least || *number > bounds.most) error(name, "out_of_range", range);
  else return number;
  return std::nullopt;
}

std::optional<bool> FieldReader::boolean(const char* name) {
  const json* value = any(name);
  if (value == nullptr) return std::nullopt;
  if (value->is_boolean()) return value->get<bool>();
  error(name, "wrong_type", "must be true or false");
  return std::nullopt;
}

std::optional<std::string> FieldReader::text(const char* name, Bounds bytes, Need need) {
  const json* value = any(name, need);
  if (value == nullptr) return std::nullopt;
  if (!value->is_string()) {
    error(name, "wrong_type", "must be a text");
    return std::nullopt;
  }
  const auto& text = value->get_ref<const std::string&>();
  if (text.size() < bytes.least || text.size() > bytes.most) {
    error(name, "out_of_range", "must have " + std::to_string(bytes.least) + " to " +
                                    std::to_string(bytes.most) + " bytes");
  } else if (has_control(text)) {
    error(name, "invalid_value", "must not hold control characters");
  } else {
    return text;
  }
  return std::nullopt;
}

std::optional<double> FieldReader::number(const char* name) {
  const json* value = any(name);
  if (value == nullptr) return std::nullopt;
  if (value->is_number() && std::isfinite(value->get<double>())) return value->get<double>();
  error(name, "wrong_type", "must be a finite number");
  return std::nullopt;
}

std::optional<std::vector<double>> FieldReader::numbers(const char* name, std::size_t count,
                                                        Need need) {
  const json* value = any(name, need);
  if (value == nullptr) return std::nullopt;
  const auto is_finite = [](const json& item) {
    return item.is_number() && std::isfinite(item.get<double>());
  };
  if (value->is_array() && value->size() == count &&
      std::all_of(value->begin(), value->end(), is_finite)) {
    return value->get<std::vector<double>>();
  }
  error(name, "wrong_type", "must be a list of " + std::to_string(count) + " finite numbers");
  return std::nullopt;
}

void FieldReader::finish() {
  for (const auto& [key, value] : object_.items()) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      error(key, "unknown_field", "no such field");
    }
  }
}

Problem problem_of_fields(std::vector<FieldError> errors) {
  const FieldError& first = errors.front();
  const std::string place = first.pointer.empty() ? "the body" : first.pointer;
  Problem problem{422, "invalid_request",
                  errors.size() == 1 ? place + ' ' + first.detail : std::to_string(errors.size()) + " fields are wrong"};
  problem.errors = std::move(errors);
  return problem;
}

}  // namespace raykiln::server
