#include "scene_draft.hpp"

#include "diagnostics.hpp"

namespace raykiln::render::io {

Material default_material(std::string_view name) {
  Material material;
  material.name = std::string(name);
  material.diffuse = Rgb(0.8F);
  return material;
}

std::uint32_t MaterialTable::intern(std::string_view name) {
  const auto found = by_name_.find(name);
  if (found != by_name_.end()) return found->second;
  const auto id = static_cast<std::uint32_t>(materials.size());
  materials.push_back(default_material(name));
  defined.push_back(false);
  by_name_.emplace(std::string(name), id);
  return id;
}

bool MaterialTable::contains(std::string_view name) const {
  return by_name_.find(name) != by_name_.end();
}

std::uint32_t SceneDraft::add_object(std::string name) {
  if (object_names.size() < kMostObjects) object_names.push_back(std::move(name));
  return static_cast<std::uint32_t>(object_names.size() - 1);
}

void SceneDraft::use_object(std::uint32_t object) {
  if (!objects.empty() && objects.back().object == object) return;
  const auto first = static_cast<std::uint32_t>(triangles.size());
  if (!objects.empty() && objects.back().first == first) objects.pop_back();
  if (!objects.empty() && objects.back().object == object) return;
  objects.push_back({first, object});
}

void SceneDraft::add_triangle(const std::array<std::uint32_t, 3>& corners,
                              const std::array<std::uint32_t, 3>& corner_normal_ids,
                              std::uint32_t material) {
  constexpr std::array<std::uint32_t, 3> kNone{kNoNormal, kNoNormal, kNoNormal};
  if (corner_normals.empty() && corner_normal_ids != kNone) {
    corner_normals.assign(triangles.size(), kNone);
  }
  triangles.push_back(corners);
  material_ids.push_back(material);
  if (!corner_normals.empty() || corner_normal_ids != kNone) {
    corner_normals.push_back(corner_normal_ids);
  }
}

}  // namespace raykiln::render::io
