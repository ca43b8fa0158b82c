#include "raykiln/api/replay_json.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace raykiln::server {
namespace {

using nlohmann::ordered_json;

/// JSON has no word for what is not finite: such a channel is a string.
ordered_json channel(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0.0 ? "inf" : "-inf";
}

double channel_of(const ordered_json& value) {
  if (!value.is_string()) return value.get<double>();
  const auto& text = value.get_ref<const std::string&>();
  if (text == "inf") return std::numeric_limits<double>::infinity();
  if (text == "-inf") return -std::numeric_limits<double>::infinity();
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::string replay_json(const ReplayView& replay) {
  const auto& [r, g, b] = replay.radiance;
  const ordered_json json{{"x", replay.x},
                          {"y", replay.y},
                          {"sample", replay.sample},
                          {"radiance", {channel(r), channel(g), channel(b)}},
                          {"dropped", replay.dropped},
                          {"truncated", replay.truncated},
                          {"bounce_rays", replay.bounce_rays},
                          {"shadow_rays", replay.shadow_rays},
                          {"light_model", replay.light_model},
                          {"seed", replay.seed},
                          {"effects", replay.effects}};
  return json.dump();
}

std::optional<ReplayView> parse_replay(std::string_view text) {
  try {
    const auto json = ordered_json::parse(text.begin(), text.end());
    ReplayView view;
    view.x = json.at("x").get<int>();
    view.y = json.at("y").get<int>();
    view.sample = json.at("sample").get<std::uint64_t>();
    for (std::size_t c = 0; c < 3; ++c) view.radiance[c] = channel_of(json.at("radiance").at(c));
    view.dropped = json.at("dropped").get<bool>();
    view.truncated = json.at("truncated").get<bool>();
    view.bounce_rays = json.at("bounce_rays").get<std::uint64_t>();
    view.shadow_rays = json.at("shadow_rays").get<std::uint64_t>();
    view.light_model = json.at("light_model").get<std::string>();
    view.seed = json.at("seed").get<std::uint64_t>();
    view.effects = json.value("effects", "");
    return view;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

}  // namespace raykiln::server
