// What an import found, in the words of the API.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/jobs/effect_report.hpp"

namespace raykiln::server {

struct SceneWarning {
  std::string code;  ///< snake_case
  std::string message;
  std::string file;
  std::string where;
  std::uint64_t count = 1;
};

struct SceneReport {
  std::string format;                ///< "obj", "gltf", "glb"
  std::string root_file;
  std::uint64_t triangles = 0;
  std::uint64_t dropped_triangles = 0;  ///< of zero area
  std::vector<std::string> materials;   ///< names; at most 1000 are kept
  std::uint64_t material_count = 0;
  std::vector<std::string> objects;     ///< likewise; none in reports of older versions
  std::uint64_t object_count = 0;
  std::uint64_t point_lights = 0, spot_lights = 0, directional_lights = 0;
  bool environment = false;  ///< lit by an environment map
  std::uint64_t emissive_triangles = 0;
  std::vector<std::string> cameras;     ///< names in the order of the scene; never empty
  std::array<double, 3> bounds_min{}, bounds_max{};  ///< metres, world space
  EffectReport effects;  ///< of a job with the default settings; none in reports of older versions
  std::vector<SceneWarning> warnings;
};

[[nodiscard]] std::string encode_report(const SceneReport& report);
[[nodiscard]] std::optional<SceneReport> decode_report(std::string_view text);

}  // namespace raykiln::server
