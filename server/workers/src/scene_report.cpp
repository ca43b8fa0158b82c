#include "raykiln/workers/scene_report.hpp"

#include <charconv>

#include "raykiln/base/record.hpp"

namespace raykiln::server {
namespace {

std::array<double, 3> read_point(const RecordReader& r, std::string_view key) {
  std::array<double, 3> point{};
  const auto& list = r.list(key);
  for (std::size_t i = 0; i < point.size() && i < list.size(); ++i) {
    std::from_chars(list[i].data(), list[i].data() + list[i].size(), point[i]);
  }
  return point;
}

std::vector<SceneWarning> read_warnings(const RecordReader& r) {
  std::vector<SceneWarning> warnings;
  const auto at = [&](const char* key, std::size_t i) {
    const auto& list = r.list(key);
    return i < list.size() ? list[i] : std::string();
  };
  for (std::size_t i = 0; i < r.list("warning.code").size(); ++i) {
    SceneWarning warning{at("warning.code", i), at("warning.message", i), at("warning.file", i),
                         at("warning.where", i), 1};
    const std::string count = at("warning.count", i);
    std::from_chars(count.data(), count.data() + count.size(), warning.count);
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace

std::string encode_report(const SceneReport& report) {
  RecordWriter r;
  r.text("format", report.format);
  r.text("root_file", report.root_file);
  r.natural("triangles", report.triangles);
  r.natural("dropped_triangles", report.dropped_triangles);
  r.natural("material_count", report.material_count);
  for (const auto& material : report.materials) r.text("material", material);
  r.natural("object_count", report.object_count);
  for (const auto& object : report.objects) r.text("object", object);
  r.natural("point_lights", report.point_lights);
  r.natural("spot_lights", report.spot_lights);
  r.natural("directional_lights", report.directional_lights);
  r.natural("environment", report.environment ? 1U : 0U);
  r.natural("emissive_triangles", report.emissive_triangles);
  for (const auto& camera : report.cameras) r.text("camera", camera);
  for (const double c : report.bounds_min) r.real("bounds_min", c);
  for (const double c : report.bounds_max) r.real("bounds_max", c);
  write_effects(r, report.effects);
  for (const SceneWarning& warning : report.warnings) {
    r.text("warning.code", warning.code);
    r.text("warning.message", warning.message);
    r.text("warning.file", warning.file);
    r.text("warning.where", warning.where);
    r.natural("warning.count", warning.count);
  }
  return r.str();
}

std::optional<SceneReport> decode_report(std::string_view text) {
  const auto parsed = RecordReader::parse(text);
  if (!parsed) return std::nullopt;
  const RecordReader& r = *parsed;
  SceneReport report;
  report.format = r.text("format");
  report.root_file = r.text("root_file");
  report.triangles = r.natural("triangles");
  report.dropped_triangles = r.natural("dropped_triangles");
  report.material_count = r.natural("material_count");
  report.materials = r.list("material");
  report.object_count = r.natural("object_count");
  report.objects = r.list("object");
  report.point_lights = r.natural("point_lights");
  report.spot_lights = r.natural("spot_lights");
  report.directional_lights = r.natural("directional_lights");
  report.environment = r.natural("environment") != 0;
  report.emissive_triangles = r.natural("emissive_triangles");
  report.cameras = r.list("camera");
  report.bounds_min = read_point(r, "bounds_min");
  report.bounds_max = read_point(r, "bounds_max");
  report.effects = read_effects(r);
  report.warnings = read_warnings(r);
  return report;
}

}  // namespace raykiln::server
