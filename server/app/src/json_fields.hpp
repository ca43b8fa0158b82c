// Objects and arrays of the small JSON that the CLI writes by itself.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "json_text.hpp"
#include "text_format.hpp"

namespace raykiln::server {

/// One object, its members in the order they were added.
class JsonFields {
 public:
  void raw(std::string_view name, std::string_view json) {
    if (text_.size() > 1) text_.push_back(',');
    text_.append(json_string(name)).append(1, ':').append(json);
  }
  void number(std::string_view name, double value) { raw(name, json_number(value)); }
  void text(std::string_view name, std::string_view value) { raw(name, json_string(value)); }
  void flag(std::string_view name, bool value) { raw(name, value ? "true" : "false"); }
  [[nodiscard]] std::string object() const { return text_ + '}'; }

 private:
  std::string text_{"{"};
};

inline std::string json_array(const std::vector<std::string>& items) {
  std::string text{"["};
  for (const auto& item : items) {
    if (text.size() > 1) text.push_back(',');
    text.append(item);
  }
  text.push_back(']');
  return text;
}

}  // namespace raykiln::server
