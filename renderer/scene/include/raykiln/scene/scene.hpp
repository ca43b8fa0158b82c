// The scene: an immutable value, validated once by renderer/io. Knows no file format and no tree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "raykiln/math/ray.hpp"
#include "raykiln/math/vec.hpp"
#include "raykiln/scene/light.hpp"

namespace raykiln::render {

inline constexpr std::uint32_t kNoNormal = 0xFFFFFFFFU;

/// Triangles from `first` on, up to the next run, are of this object.
struct ObjectRun {
  std::uint32_t first = 0;
  std::uint32_t object = 0;
};

/// All triangles of the scene, in world space relative to Scene::origin, in metres.
/// Counter-clockwise winding faces outwards. The triangle id is its index here.
struct TriangleMesh {
  std::vector<Vec3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;       ///< indices into positions
  std::vector<std::uint32_t> material_ids;                   ///< one a triangle
  std::vector<Vec3f> normals;                                ///< unit; empty when nothing has any
  std::vector<std::array<std::uint32_t, 3>> corner_normals;  ///< empty, or one a triangle; kNoNormal
  std::vector<ObjectRun> objects{};  ///< by rising first; triangles before the first run are of object 0
};

/// Number of the object that triangle `id` is of.
[[nodiscard]] std::uint32_t object_of(const TriangleMesh& mesh, std::uint32_t id);

/// Which formulas a material follows.
enum class SurfaceModel : std::uint8_t {
  kPhong,       ///< the seed's BSDF, section 3
  kMicrofacet,  ///< GGX: glTF's metallic-roughness model
};

/// What a microfacet surface has beside the common members of Material.
struct Microfacets {
  double roughness = 1.0;  ///< [0, 1]; alpha is its square
  float edge = 1.0F;       ///< reflectance of the opaque share at grazing; `specular` is that at normal
  Rgb diffuse_through{0.0F};  ///< albedo of the diffuse base towards the far side; `diffuse` is that of the near one
  Rgb tint{1.0F};          ///< of what the transparent share lets through, [0, 1]
  bool thin = true;        ///< a sheet, which does not bend light; else the border of a body
  Rgb absorption{0.0F};    ///< m^-1, inside of the body
};

/// The seed's BSDF, section 3: f = diffuse [transparent a/(2 pi) + (1 - transparent) a/pi]
///   + specular [transparent f_st + (1 - transparent) f_ph]; the RGB weights contain a.
/// Or kMicrofacet: (1 - transparent) of a diffuse base of albedo `diffuse` below facets that reflect from
/// `specular` at normal to `facets.edge` at grazing incidence, and `transparent` of a clear border.
struct Material {
  std::string name;
  Rgb diffuse{0.0F};
  Rgb specular{0.0F};
  float transparent = 0.0F;  ///< [0, 1]: share that also transmits
  double specular_exp = 1.0; ///< Phong exponent e >= 0
  float index_of_refraction = 1.0F;  ///< of the side behind the geometric normal; vacuum in front
  Rgb emission{0.0F};                ///< radiance, W sr^-1 m^-2, both sides unless one_sided
  SurfaceModel model = SurfaceModel::kPhong;
  Microfacets facets{};              ///< of kMicrofacet only
  /// [0, 1]: share of the light that meets the surface at all; the rest passes straight on. A texture
  /// may change it from point to point, see coverage_at().
  float coverage = 1.0F;
  /// Seen from behind it is not there: rays that come from there pass, and it shines to the front alone.
  bool one_sided = false;
};

/// Does it reflect or let through anything of what meets it?
[[nodiscard]] inline bool scatters(const Material& m) {
  const Rgb black(0.0F);
  if (m.diffuse != black || m.specular != black) return true;
  return m.model == SurfaceModel::kMicrofacet &&
         (m.transparent > 0.0F || m.facets.edge > 0.0F || m.facets.diffuse_through != black);
}

/// May light that arrives from behind be seen?
[[nodiscard]] inline bool transmits(const Material& m) {
  return m.transparent > 0.0F ||
         (m.model == SurfaceModel::kMicrofacet && m.facets.diffuse_through != Rgb(0.0F));
}

enum class Projection : std::uint8_t { kPerspective, kOrthographic };

/// A thin lens. What lies `focus_distance` along the camera's forward is sharp.
struct Lens {
  double radius = 0.0;          ///< metres; 0 is a pinhole
  double focus_distance = 1.0;  ///< metres, > 0
};

/// right, up, forward are orthonormal (right = forward x up); fov is the full vertical
/// angle. An orthographic camera looks along forward from all of the rectangle about its eye, and sees
/// nothing behind it. Pixel (0, 0) is at the top left. In double: from 10^6 times the scene's size one step of a
/// float eye, or of a float direction, is as long as 6 % of the scene.
struct Camera {
  std::string name;
  Vec3d eye{0.0};  ///< relative to Scene::origin
  Vec3d right{1.0, 0.0, 0.0};
  Vec3d up{0.0, 1.0, 0.0};
  Vec3d forward{0.0, 0.0, -1.0};
  double fov_y_rad = 0.7;       ///< of kPerspective
  Projection projection = Projection::kPerspective;
  double view_height = 1.0;     ///< of kOrthographic: from the picture's lower edge to its upper one, metres
  Lens lens{};
};

struct EnvironmentMap;   // environment_map.hpp
struct SurfaceTextures;  // surface_textures.hpp

struct Scene {
  TriangleMesh mesh;
  std::vector<Material> materials;
  std::vector<std::string> object_names{};  ///< by number; empty in scenes that are put together by hand
  std::vector<PointLight> point_lights;
  std::vector<SpotLight> spot_lights;
  std::vector<DirectionalLight> directional_lights;
  std::vector<Camera> cameras;  ///< never empty: a default one frames the bounds
  Rgb background{0.0F};         ///< radiance of a ray that meets nothing
  std::shared_ptr<const EnvironmentMap> environment{};  ///< adds to the background; null: none
  std::shared_ptr<const SurfaceTextures> textures{};    ///< null: no material has any
  Vec3d origin{0.0};            ///< world position of the local (0, 0, 0): positions were re-centred
  Bounds3f bounds;              ///< of mesh.positions that triangles use
};

}  // namespace raykiln::render
