#include "raykiln/api/message.hpp"

namespace raykiln::server {

const std::string* find_value(const std::vector<NamedValue>& list, std::string_view name) {
  for (const auto& [key, value] : list) {
    if (key == name) return &value;
  }
  return nullptr;
}

}  // namespace raykiln::server
