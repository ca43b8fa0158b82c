#include "raykiln/api/picture_name.hpp"

namespace raykiln::server {

std::string file_name_text(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool fits = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
                      c == '_' || c == '-';
    name.push_back(fits ? c : '_');
  }
  if (name.starts_with('.')) name.front() = '_';
  return name.substr(0, 100);
}

std::string picture_name(std::string_view scene, std::string_view camera, std::string_view setting) {
  std::string name = file_name_text(scene);
  if (!camera.empty()) name += '-' + file_name_text(camera);
  if (!setting.empty()) name += '-' + file_name_text(setting);
  return name;
}

}  // namespace raykiln::server
