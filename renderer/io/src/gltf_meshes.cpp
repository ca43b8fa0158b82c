#include "gltf_meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace raykiln::render::io {
namespace {

constexpr std::uint64_t kTriangles = 4;
constexpr std::uint64_t kStrip = 5;
constexpr std::uint64_t kFan = 6;
constexpr std::uint64_t kItemsPerPoll = 1 << 16;

// Rows of the cofactor matrix: the inverse transpose times the determinant, which exists also for
// flat transforms.
std::array<Vec3d, 3> cofactors(const Mat4d& m) {
  const Vec3d x(m[0]);
  const Vec3d y(m[1]);
  const Vec3d z(m[2]);
  return {cross(y, z), cross(z, x), cross(x, y)};
}

double determinant(const Mat4d& m) { return dot(Vec3d(m[0]), cofactors(m)[0]); }

// Corners of triangle i, glTF 2.0 section 3.7.2.1; strips alternate so that the winding stays.
std::array<std::uint64_t, 3> corners_of(std::uint64_t mode, std::uint64_t i) {
  if (mode == kTriangles) return {3 * i, 3 * i + 1, 3 * i + 2};
  if (mode == kStrip) return {i, i + 1 + i % 2, i + 2 - i % 2};
  return {i + 1, i + 2, 0};
}

std::uint64_t triangle_count(std::uint64_t mode, std::uint64_t corners) {
  if (mode == kTriangles) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// Each component by itself: the largest of several is not NaN when a later one is.
Vec3f unit_or_zero(const Vec3d& n) {
  const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  const bool finite = std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z);
  if (!finite || !(largest > 0.0)) return Vec3f(0.0F);
  return Vec3f(normalize(n / largest));
}

}  // namespace

GltfMeshes::GltfMeshes(const JsonAt& root, GltfAccessors& accessors,
                       std::vector<std::uint32_t> material_ids, SceneDraft& draft)
    : meshes_(root.array("meshes")),
      accessors_(&accessors),
      material_ids_(std::move(material_ids)),
      draft_(&draft) {}

bool GltfMeshes::instantiate(std::uint64_t index, const Mat4d& to_world, const JsonAt& at) {
  if (!meshes_ || index >= meshes_->size()) {
    return at.fail(ImportErrorCode::kIndexOutOfRange, "there is no mesh " + std::to_string(index));
  }
  const JsonAt mesh = meshes_->element(static_cast<std::size_t>(index));
  if (!mesh.expect_object()) return false;
  const auto primitives = mesh.array("primitives");
  if (!primitives) {
    return mesh.fail(ImportErrorCode::kMissingField, "the mesh has no primitives");
  }
  for (std::size_t i = 0; i < primitives->size(); ++i) {
    if (!at.diagnostics().may_go_on()) return false;
    if (!primitive(primitives->element(i), to_world)) return false;
  }
  return true;
}

bool GltfMeshes::primitive(const JsonAt& at, const Mat4d& to_world) {
  if (!at.expect_object()) return false;
  if (++primitive_visits_ > at.diagnostics().limits().max_primitive_visits) {
    return at.fail(ImportErrorCode::kLimitExceeded, "the scene has too many primitives");
  }
  const auto attributes = at.object("attributes");
  const std::uint64_t mode = at.integer_or("mode", kTriangles);
  if (at.diagnostics().failed()) return false;
  if (!attributes) return at.fail(ImportErrorCode::kMissingField, "the primitive has no attributes");
  if (mode > kFan) return at.fail(ImportErrorCode::kInvalidValue, "mode is 0 to 6");
  if (mode < kTriangles) {
    at.warn(ImportWarningCode::kIgnoredElement, "points and lines have no surface and are ignored");
    return true;
  }
  if (!attributes->has("POSITION")) {
    at.warn(ImportWarningCode::kIgnoredElement, "primitives without POSITION are ignored");
    return true;
  }
  const auto position = attributes->member("POSITION").integer();
  if (!position) return false;
  if (!accessors_->has_bytes(*position, at)) {
    if (at.diagnostics().failed()) return false;
    at.warn(ImportWarningCode::kIgnoredElement,
            "primitives whose positions have no bytes are ignored");
    return true;
  }
  Placed placed;
  placed.mirrored = determinant(to_world) < 0.0;
  note_ignored(at, *attributes);
  return material_of(at, placed.material) && place_vertices(at, *attributes, to_world, placed) &&
         place_normals(at, *attributes, to_world, placed) &&
         place_uvs(at, *attributes, 0, placed) && place_uvs(at, *attributes, 1, placed) &&
         triangles(at, mode, placed);
}

void GltfMeshes::note_ignored(const JsonAt& at, const JsonAt& attributes) {
  if (at.has("targets")) {
    at.warn(ImportWarningCode::kIgnoredFeature, "morph targets are ignored: the rest pose is shown");
  }
  if (attributes.has("COLOR_0")) {
    at.warn(ImportWarningCode::kIgnoredFeature, "vertex colours and their alpha are ignored");
  }
}

bool GltfMeshes::material_of(const JsonAt& at, std::uint32_t& id) {
  if (!at.has("material")) {
    id = draft_->materials.intern(kDefaultMaterialName);
    return true;
  }
  const auto index = at.member("material").integer();
  if (!index) return false;
  if (*index >= material_ids_.size()) {
    return at.fail(ImportErrorCode::kIndexOutOfRange,
                   "there is no material " + std::to_string(*index));
  }
  id = material_ids_[static_cast<std::size_t>(*index)];
  return true;
}

bool GltfMeshes::place_vertices(const JsonAt& at, const JsonAt& attributes, const Mat4d& to_world,
                                Placed& placed) {
  const ImportLimits& limits = at.diagnostics().limits();
  const JsonAt where = attributes.member("POSITION");
  const auto accessor = where.integer();
  const auto count = accessor ? accessors_->count(*accessor, where) : std::nullopt;
  if (!count) return false;
  if (*count > limits.max_vertices - draft_->positions.size()) {
    return at.fail(ImportErrorCode::kLimitExceeded,
                   "the scene has more than " + std::to_string(limits.max_vertices) + " vertices");
  }
  const auto values = accessors_->vectors(*accessor, where);
  if (!values) return false;
  placed.vertices = values->size();
  placed.first_position = static_cast<std::uint32_t>(draft_->positions.size());
  for (std::size_t i = 0; i < values->size(); ++i) {
    const Vec3d p(to_world * Vec4d((*values)[i], 1.0));
    const bool in_range = std::abs(p.x) <= limits.max_coordinate &&
                          std::abs(p.y) <= limits.max_coordinate &&
                          std::abs(p.z) <= limits.max_coordinate;  // false for NaN
    if (!in_range) {
      return where.fail(ImportErrorCode::kCoordinateTooLarge,
                        "vertex " + std::to_string(i) + " lies too far out in the world",
                        "use a larger unit");
    }
    draft_->positions.push_back(p);
  }
  return true;
}

bool GltfMeshes::place_normals(const JsonAt& at, const JsonAt& attributes, const Mat4d& to_world,
                               Placed& placed) {
  if (!attributes.has("NORMAL")) return true;
  const JsonAt where = attributes.member("NORMAL");
  const auto accessor = where.integer();
  const auto count = accessor ? accessors_->count(*accessor, where) : std::nullopt;
  if (!count) return false;
  if (*count != placed.vertices) {
    return where.fail(ImportErrorCode::kInvalidValue,
                      "there are " + std::to_string(*count) + " normals for " +
                          std::to_string(placed.vertices) + " vertices");
  }
  if (*count > at.diagnostics().limits().max_vertices - draft_->normals.size()) {
    return at.fail(ImportErrorCode::kLimitExceeded, "the scene has too many normals");
  }
  const auto values = accessors_->vectors(*accessor, where);
  if (!values) return false;
  placed.first_normal = static_cast<std::uint32_t>(draft_->normals.size());
  const auto columns = cofactors(to_world);
  const double sign = placed.mirrored ? -1.0 : 1.0;
  for (const Vec3d& n : *values) {
    draft_->normals.push_back(
        unit_or_zero(sign * (columns[0] * n.x + columns[1] * n.y + columns[2] * n.z)));
  }
  return true;
}

// Only for materials with a texture that reads this set.
bool GltfMeshes::place_uvs(const JsonAt& at, const JsonAt& attributes, std::size_t set,
                           Placed& placed) {
  const DraftTextures& textures = draft_->textures;
  if (placed.material >= textures.materials.size()) return true;
  const MaterialTextures& used = textures.materials[placed.material];
  const auto uses = used.uses();
  const bool reads = std::any_of(uses.begin(), uses.end(), [set](const TextureUse* use) {
    return use->used() && use->uv_set == set;
  });
  if (!reads) return true;
  const char* key = set == 0 ? "TEXCOORD_0" : "TEXCOORD_1";
  if (!attributes.has(key)) return true;  // finish_scene lists it
  const JsonAt where = attributes.member(key);
  const auto accessor = where.integer();
  const auto count = accessor ? accessors_->count(*accessor, where) : std::nullopt;
  if (!count) return false;
  if (*count != placed.vertices) {
    return where.fail(ImportErrorCode::kInvalidValue,
                      "there are " + std::to_string(*count) + " texture coordinates for " +
                          std::to_string(placed.vertices) + " vertices");
  }
  std::vector<Vec2f>& coordinates = draft_->textures.uv_sets[set].coordinates;
  if (*count > at.diagnostics().limits().max_vertices - coordinates.size()) {
    return at.fail(ImportErrorCode::kLimitExceeded, "the scene has too many texture coordinates");
  }
  const auto values = accessors_->pairs(*accessor, where);
  if (!values) return false;
  placed.first_uv[set] = static_cast<std::uint32_t>(coordinates.size());
  for (const Vec3d& uv : *values) coordinates.emplace_back(uv.x, uv.y);
  return true;
}

bool GltfMeshes::triangles(const JsonAt& at, std::uint64_t mode, const Placed& placed) {
  std::vector<std::uint32_t> ids;
  std::uint64_t corners = placed.vertices;
  if (at.has("indices")) {
    const JsonAt where = at.member("indices");
    const auto accessor = where.integer();
    auto read = accessor ? accessors_->indices(*accessor, where) : std::nullopt;
    if (!read) return false;
    ids = std::move(*read);
    corners = ids.size();
    const auto bad = std::find_if(ids.begin(), ids.end(),
                                  [&](std::uint32_t id) { return id >= placed.vertices; });
    if (bad != ids.end()) {
      return where.fail(ImportErrorCode::kIndexOutOfRange,
                        "index " + std::to_string(bad - ids.begin()) + " is " +
                            std::to_string(*bad) + ", but there are " +
                            std::to_string(placed.vertices) + " vertices");
    }
  }
  const std::uint64_t count = triangle_count(mode, corners);
  const std::uint64_t limit = at.diagnostics().limits().max_triangles;
  if (count > limit - draft_->triangles.size()) {
    return at.fail(ImportErrorCode::kLimitExceeded,
                   "the scene has more than " + std::to_string(limit) + " triangles",
                   "simplify or split the scene");
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i % kItemsPerPoll == 0 && !at.diagnostics().may_go_on()) return false;
    auto corner = corners_of(mode, i);
    if (placed.mirrored) std::swap(corner[1], corner[2]);
    std::array<std::uint32_t, 3> position{};
    std::array<std::uint32_t, 3> normal{kNoNormal, kNoNormal, kNoNormal};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto id = ids.empty() ? static_cast<std::uint32_t>(corner[k])
                                  : ids[static_cast<std::size_t>(corner[k])];
      position[k] = placed.first_position + id;
      if (placed.first_normal != kNoNormal) normal[k] = placed.first_normal + id;
    }
    draft_->add_triangle(position, normal, placed.material);
    for (std::size_t set = 0; set < 2; ++set) {
      if (placed.first_uv[set] == kNoUv) continue;
      std::array<std::uint32_t, 3> uv{};
      for (std::size_t k = 0; k < 3; ++k) {
        uv[k] = placed.first_uv[set] + position[k] - placed.first_position;
      }
      draft_->textures.add_corners(set, draft_->triangles.size() - 1, uv);
    }
  }
  return true;
}

}  // namespace raykiln::render::io
