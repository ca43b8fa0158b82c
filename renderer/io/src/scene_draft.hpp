// The scene while it is being read: double precision, file units, nothing validated as a whole yet.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "draft_textures.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render::io {

inline constexpr std::size_t kMaxNameBytes = 1024;  ///< of a material's name; the rest is cut
inline constexpr std::size_t kMostObjects = 100'000;  ///< that are told apart
inline constexpr std::string_view kDefaultMaterialName = "default";

enum class LightKind { kPoint, kSpot, kDirectional };

/// A light without a surface, of any kind.
struct DraftLight {
  std::string name;
  LightKind kind = LightKind::kPoint;
  Vec3d position{0.0};
  Rgbd power{0.0};  ///< intensity, W sr^-1; of a directional light irradiance, W m^-2
  double range = kNoRange;  ///< in the units of positions
  Vec3d direction{0.0, 0.0, -1.0};  ///< in which it shines, any length > 0
  double inner_rad = 0.0, outer_rad = 0.0;  ///< of a spot: 0 <= inner <= outer <= pi, from the axis

  static constexpr double kNoRange = std::numeric_limits<double>::infinity();
};

struct DraftCamera {
  std::string name;
  Vec3d eye{0.0};
  Vec3d forward{0.0, 0.0, -1.0};  ///< any length > 0
  Vec3d up{0.0, 1.0, 0.0};        ///< not parallel to forward
  double fov_y_rad = 0.7;
  double view_height = 0.0;     ///< in the units of positions; above 0: orthographic
  double lens_radius = 0.0;     ///< in the units of positions
  double focus_distance = 1.0;  ///< in the units of positions
};

/// Materials are known by name: a face may use one before (or without) its definition.
class MaterialTable {
 public:
  /// Index of the material called `name`; makes an undefined one when there is none.
  std::uint32_t intern(std::string_view name);
  [[nodiscard]] bool contains(std::string_view name) const;
  [[nodiscard]] std::size_t size() const { return materials.size(); }

  std::vector<Material> materials;
  std::vector<bool> defined;  ///< false: used by a face, never described
  std::map<std::uint32_t, Material> as_phong;  ///< of those with microfacets: the nearest of the seed's model

 private:
  std::map<std::string, std::uint32_t, std::less<>> by_name_;
};

/// What faces without a described material look like: a light grey diffuse surface.
[[nodiscard]] Material default_material(std::string_view name);

struct SceneDraft {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;  ///< unit
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::array<std::uint32_t, 3>> corner_normals;  ///< empty until one has a normal
  std::vector<std::uint32_t> material_ids;
  std::vector<ObjectRun> objects;          ///< of triangles, as in TriangleMesh
  std::vector<std::string> object_names;
  MaterialTable materials;
  DraftTextures textures;
  std::vector<DraftLight> lights;
  std::vector<DraftCamera> cameras;
  std::optional<Rgbd> background;  ///< set by a sidecar only
  std::shared_ptr<const EnvironmentMap> environment;  ///< likewise
  double metres_per_unit = 1.0;
  bool single_precision = false;  ///< the file format stores positions as float

  /// A new object, for use_object(); beyond kMostObjects the last one again.
  [[nodiscard]] std::uint32_t add_object(std::string name);
  /// Triangles that are added from here on are of this object.
  void use_object(std::uint32_t object);
  void add_triangle(const std::array<std::uint32_t, 3>& corners,
                    const std::array<std::uint32_t, 3>& corner_normal_ids, std::uint32_t material);
};

}  // namespace raykiln::render::io
