#include "value.hpp"

#include <algorithm>

#include "../json_fields.hpp"

namespace raykiln::server {
namespace {

bool digits(std::string_view text, std::size_t& at) {
  const std::size_t start = at;
  while (at < text.size() && text[at] >= '0' && text[at] <= '9') ++at;
  return at > start;
}

/// RFC 8259, section 6.
bool is_json_number(std::string_view text) {
  std::size_t at = text.starts_with('-') ? 1 : 0;
  const bool zero = at < text.size() && text[at] == '0';
  if (zero) ++at;
  else if (!digits(text, at)) return false;
  if (at < text.size() && text[at] == '.' && !digits(text, ++at)) return false;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    ++at;
    if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
    if (!digits(text, at)) return false;
  }
  return at == text.size();
}

std::string scalar_json(const Value& value) {
  const bool bare = !value.quoted && (value.text == "true" || value.text == "false" || value.text == "null" ||
                                      is_json_number(value.text));
  return bare ? value.text : json_string(value.text);
}

}  // namespace

const Value* Value::find(std::string_view key) const {
  const auto found = std::find_if(map.begin(), map.end(), [key](const auto& entry) { return entry.first == key; });
  return found == map.end() ? nullptr : &found->second;
}

void Value::set(const std::string& key, Value value) {
  kind = Kind::kMap;
  const auto found = std::find_if(map.begin(), map.end(), [&key](const auto& entry) { return entry.first == key; });
  if (found != map.end()) found->second = std::move(value);
  else map.emplace_back(key, std::move(value));
}

Value text_value(std::string text) {
  Value value;
  value.kind = Value::Kind::kScalar;
  value.text = std::move(text);
  value.quoted = true;
  return value;
}

std::string to_json(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kScalar: return scalar_json(value);
    case Value::Kind::kList: {
      std::vector<std::string> items;
      for (const Value& item : value.list) items.push_back(to_json(item));
      return json_array(items);
    }
    case Value::Kind::kMap: {
      JsonFields fields;
      for (const auto& [key, item] : value.map) fields.raw(key, to_json(item));
      return fields.object();
    }
    case Value::Kind::kNull: break;
  }
  return "null";
}

}  // namespace raykiln::server
