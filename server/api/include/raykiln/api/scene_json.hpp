// Scenes as JSON, and back as far as a client needs them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/scheduler/views.hpp"

namespace raykiln::server {

/// Schema Scene.
[[nodiscard]] std::string scene_json(const SceneView& scene);
[[nodiscard]] std::string scene_page_json(const std::vector<SceneView>& scenes,
                                          const std::string& next_cursor);

struct SceneSummary {
  std::string id, name, kind, cache;
  std::uint64_t triangles = 0;
  std::vector<std::string> warnings;  ///< "message (where)"
};
[[nodiscard]] std::optional<SceneSummary> parse_scene(std::string_view text);
struct ScenePageView {
  std::vector<SceneSummary> scenes;
  std::string next_cursor;
};
[[nodiscard]] std::optional<ScenePageView> parse_scene_page(std::string_view text);

/// "code: detail (where)" of a problem, or the text itself when it is none.
[[nodiscard]] std::string problem_text(std::string_view text);

}  // namespace raykiln::server
