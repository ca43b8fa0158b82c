#include "finish_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>

#include "material_mapping.hpp"
#include "raykiln/scene/camera.hpp"
#include "raykiln/scene/environment_map.hpp"
#include "recentre.hpp"
#include "zero_area.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::size_t kItemsPerPoll = 1 << 16;
constexpr float kDefaultBackground = 0.3F;
/// W m^-2 that the default lamp sends to the middle of the scene: white reflects about radiance 1.
constexpr double kDefaultLampIrradiance = 3.0;
constexpr double kDefaultFovRad = 0.7;
constexpr double kLargestFloat = std::numeric_limits<float>::max();

class Finisher {
 public:
  Finisher(SceneDraft& draft, Diagnostics& diagnostics, Scene& scene, ImportReport& report)
      : draft_(draft), diagnostics_(diagnostics), scene_(scene), report_(report) {}

  bool run() {
    report_.source_triangles = draft_.triangles.size();
    if (!measure()) return false;
    scene_.origin = choose_origin(bounds_);
    warn_about_digits();
    if (!round_positions() || !drop_flat_triangles()) return false;
    scene_.mesh.normals = std::move(draft_.normals);
    finish_materials();
    return finish_textures() && finish_lights() && finish_cameras() && finish_background();
  }

 private:
  bool empty() {
    return diagnostics_.fail(ImportErrorCode::kEmptyScene, "the scene has no triangle with an area",
                             report_.root_file, "", "export faces, not only points or lines");
  }

  // Scales, checks and bounds the positions that triangles use.
  bool measure() {
    if (draft_.triangles.empty()) return empty();
    const double limit = diagnostics_.limits().max_coordinate;
    bounds_ = {Vec3d(std::numeric_limits<double>::infinity()),
               Vec3d(-std::numeric_limits<double>::infinity())};
    for (Vec3d& p : draft_.positions) p *= draft_.metres_per_unit;
    for (std::size_t i = 0; i < draft_.triangles.size(); ++i) {
      if (i % kItemsPerPoll == 0 && !diagnostics_.may_go_on()) return false;
      for (const std::uint32_t id : draft_.triangles[i]) {
        const Vec3d& p = draft_.positions[id];
        bounds_.lo = glm::min(bounds_.lo, p);
        bounds_.hi = glm::max(bounds_.hi, p);
      }
    }
    const Vec3d far = glm::max(glm::abs(bounds_.lo), glm::abs(bounds_.hi));
    if (far.x <= limit && far.y <= limit && far.z <= limit) return true;
    return diagnostics_.fail(ImportErrorCode::kCoordinateTooLarge,
                             "a coordinate is too large after scaling", report_.root_file, "",
                             "use a larger unit");
  }

  // A format that stores floats has lost its digits before we could re-centre.
  void warn_about_digits() {
    const Vec3d far = glm::max(glm::abs(bounds_.lo), glm::abs(bounds_.hi));
    const Vec3d size = bounds_.hi - bounds_.lo;
    const double largest_side = std::max({size.x, size.y, size.z});
    const double farthest = std::max({far.x, far.y, far.z});
    if (!(farthest > 0.0)) return;  // one point at the origin
    const double spacing = std::ldexp(1.0, std::ilogb(farthest) - 23);
    if (!draft_.single_precision || spacing * 1e4 < largest_side) return;
    char ratio[32];
    std::snprintf(ratio, sizeof ratio, "%.3g", shortest_edge() / spacing);
    diagnostics_.warn(ImportWarningCode::kCoarseCoordinates,
                      "the scene lies so far from its origin that single-precision coordinates "
                      "resolve less than 1/10000 of its size; its shortest edge is " +
                          std::string(ratio) + " of their steps long",
                      report_.root_file);
  }

  // Of those that have a length; in the units of the scaled positions.
  [[nodiscard]] double shortest_edge() const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const auto& t : draft_.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double edge = length(draft_.positions[t[(k + 1) % 3]] - draft_.positions[t[k]]);
        if (edge > 0.0) shortest = std::min(shortest, edge);
      }
    }
    return shortest;
  }

  // Unused positions may be anything: they are not looked at, and not kept finite for anybody.
  bool round_positions() {
    std::vector<Vec3f>& positions = scene_.mesh.positions;
    positions.resize(draft_.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (i % kItemsPerPoll == 0 && !diagnostics_.may_go_on()) return false;
      positions[i] = Vec3f(draft_.positions[i] - scene_.origin);
    }
    return true;
  }

  bool drop_flat_triangles() {
    TriangleMesh& mesh = scene_.mesh;
    const bool with_normals = !draft_.corner_normals.empty();
    std::size_t kept = 0;
    std::uint64_t collapsed = 0;
    std::size_t run = 0;
    for (std::size_t i = 0; i < draft_.triangles.size(); ++i) {
      if (i % kItemsPerPoll == 0 && !diagnostics_.may_go_on()) return false;
      for (; run < draft_.objects.size() && draft_.objects[run].first == i; ++run) {
        draft_.objects[run].first = static_cast<std::uint32_t>(kept);
      }
      const auto t = draft_.triangles[i];
      if (has_zero_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]])) {
        collapsed += had_area(t) ? 1U : 0U;
        continue;
      }
      for (const std::uint32_t id : t) scene_.bounds.grow(mesh.positions[id]);
      draft_.triangles[kept] = t;
      draft_.material_ids[kept] = draft_.material_ids[i];
      if (with_normals) draft_.corner_normals[kept] = usable(draft_.corner_normals[i]);
      for (UvSet& set : draft_.textures.uv_sets) move_uv(set, i, kept);
      ++kept;
    }
    report_dropped(draft_.triangles.size() - kept, collapsed);
    draft_.positions = {};
    draft_.triangles.resize(kept);
    for (UvSet& set : draft_.textures.uv_sets) {
      set.corners.resize(std::min(set.corners.size(), kept));
    }
    draft_.material_ids.resize(kept);
    if (with_normals) draft_.corner_normals.resize(kept);
    mesh.triangles = std::move(draft_.triangles);
    mesh.material_ids = std::move(draft_.material_ids);
    mesh.corner_normals = std::move(draft_.corner_normals);
    draft_.objects.resize(run);  // those behind have no triangle
    mesh.objects = std::move(draft_.objects);
    scene_.object_names = std::move(draft_.object_names);
    return kept > 0 || empty();
  }

  // Triangles beyond the end of a set have no coordinates in it.
  static void move_uv(UvSet& set, std::size_t from, std::size_t to) {
    if (to < set.corners.size()) {
      set.corners[to] = from < set.corners.size()
                            ? set.corners[from]
                            : std::array<std::uint32_t, 3>{kNoUv, kNoUv, kNoUv};
    }
  }

  // Up to the rounding of double; the question is only which warning to give.
  [[nodiscard]] bool had_area(const std::array<std::uint32_t, 3>& t) const {
    const Vec3d u = draft_.positions[t[1]] - draft_.positions[t[0]];
    const Vec3d v = draft_.positions[t[2]] - draft_.positions[t[0]];
    return length(cross(u, v)) > 1e-12 * length(u) * length(v);
  }

  // A normal of length 0 says nothing: the corner takes the normal of the triangle.
  std::array<std::uint32_t, 3> usable(std::array<std::uint32_t, 3> ids) {
    for (std::uint32_t& id : ids) {
      if (id == kNoNormal || draft_.normals[id] != Vec3f(0.0F)) continue;
      id = kNoNormal;
      ++invalid_normals_;
    }
    return ids;
  }

  void report_dropped(std::uint64_t flat, std::uint64_t collapsed) {
    report_.zero_area_triangles = flat;
    if (flat > collapsed) {
      diagnostics_.warn(ImportWarningCode::kZeroAreaTriangles,
                        "triangles without area cannot be hit and are dropped", report_.root_file,
                        "", flat - collapsed);
    }
    if (invalid_normals_ > 0) {
      diagnostics_.warn(ImportWarningCode::kInvalidNormal,
                        "normals that are not finite or have no length are replaced by those of the triangles",
                        report_.root_file, "", invalid_normals_);
    }
    if (collapsed > 0) {
      diagnostics_.warn(ImportWarningCode::kCollapsedTriangles,
                        "triangles too small for single precision lost their area and are dropped",
                        report_.root_file, "", collapsed);
    }
  }

  void finish_materials() {
    const MaterialTable& table = draft_.materials;
    used_.assign(table.size(), false);
    for (const std::uint32_t id : scene_.mesh.material_ids) used_[id] = true;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const Material& material = table.materials[i];
      if (used_[i] && !table.defined[i]) warn_undefined(material.name);
      if (used_[i] && largest_albedo(material) > 1.0001F) {
        diagnostics_.warn(ImportWarningCode::kNotConserving,
                          "material " + in_quotes(material.name) +
                              " reflects more than it receives: diffuse + specular is above 1",
                          report_.root_file);
      }
    }
    scene_.materials = std::move(draft_.materials.materials);
    for (Material& material : scene_.materials) {
      material.facets.absorption *= static_cast<float>(1.0 / draft_.metres_per_unit);
    }
  }

  void warn_undefined(const std::string& name) {
    if (name == kDefaultMaterialName) {
      diagnostics_.warn(ImportWarningCode::kDefaultMaterial,
                        "faces without a material are diffuse grey", report_.root_file);
    } else {
      diagnostics_.warn(ImportWarningCode::kUnknownMaterial,
                        "material " + in_quotes(name) + " is not defined and becomes diffuse grey",
                        report_.root_file);
    }
  }

  // Pictures and coordinates that no triangle's material reads are dropped here.
  bool finish_textures() {
    DraftTextures& draft = draft_.textures;
    draft.materials.resize(scene_.materials.size());
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (!used_[i]) draft.materials[i] = {};
    }
    if (!draft.any()) return true;
    auto textures = std::make_shared<SurfaceTextures>();
    std::vector<std::uint32_t> new_id(draft.images.size(), kNoTexture);
    const auto keep = [&](TextureUse& use) {
      if (!use.used()) return;
      if (new_id[use.image] == kNoTexture) {
        new_id[use.image] = static_cast<std::uint32_t>(textures->images.size());
        textures->images.push_back(std::move(draft.images[use.image]));
      }
      use.image = new_id[use.image];
    };
    std::array<bool, 2> set_used{};
    for (std::size_t i = 0; i < draft.materials.size(); ++i) {
      if (!scale_emission(i)) return false;
      MaterialTextures& used = draft.materials[i];
      for (TextureUse* use : used.uses()) {
        keep(*use);
        if (use->used()) set_used[use->uv_set] = true;
      }
    }
    for (std::size_t set = 0; set < 2; ++set) {
      if (set_used[set]) textures->uv_sets[set] = std::move(draft.uv_sets[set]);
    }
    textures->materials = std::move(draft.materials);
    check_corners(*textures);
    scene_.textures = std::move(textures);
    return diagnostics_.may_go_on();
  }

  // Values of a texture are at most 1; what its picture was divided by goes to the factor.
  bool scale_emission(std::size_t id) {
    const TextureUse& use = draft_.textures.materials[id].emission;
    if (!use.used()) return true;
    Material& material = scene_.materials[id];
    const Rgbd scaled = Rgbd(material.emission) * draft_.textures.scales[use.image];
    if (!(std::max({scaled.x, scaled.y, scaled.z}) <= diagnostics_.limits().max_radiance)) {
      return diagnostics_.fail(
          ImportErrorCode::kInvalidValue,
          "the emission of material " + in_quotes(material.name) + " times its texture is too bright",
          report_.root_file);
    }
    material.emission = Rgb(scaled);
    return true;
  }

  // An index beyond the coordinates is none. Triangles whose texture has no place are listed.
  void check_corners(SurfaceTextures& textures) {
    for (UvSet& set : textures.uv_sets) {
      for (auto& corners : set.corners) {
        for (std::uint32_t& id : corners) {
          if (id >= set.coordinates.size()) id = kNoUv;
        }
      }
    }
    std::uint64_t missing = 0;
    for (std::size_t i = 0; i < scene_.mesh.triangles.size(); ++i) {
      const MaterialTextures& used = textures.materials[scene_.mesh.material_ids[i]];
      for (const TextureUse* use : used.uses()) {
        if (!use->used()) continue;
        const auto& corners = textures.uv_sets[use->uv_set].corners;
        const bool complete = i < corners.size() && corners[i][0] != kNoUv &&
                              corners[i][1] != kNoUv && corners[i][2] != kNoUv;
        missing += complete ? 0U : 1U;
      }
    }
    if (missing > 0) {
      diagnostics_.warn(ImportWarningCode::kIgnoredTexture,
                        "triangles with a texture but without texture coordinates are plain",
                        report_.root_file, "", missing);
    }
  }

  bool finish_lights() {
    for (DraftLight& light : draft_.lights) {
      if (Rgb(light.power) == Rgb(0.0F)) {
        diagnostics_.warn(ImportWarningCode::kZeroLight, "lights without power are dropped");
        continue;
      }
      if (light.kind == LightKind::kDirectional) {
        scene_.directional_lights.push_back({.name = std::move(light.name),
                                             .direction = normalize(light.direction),
                                             .irradiance = Rgb(light.power)});
        continue;
      }
      const Vec3d p = light.position * draft_.metres_per_unit - scene_.origin;
      if (!in_range(p)) return out_of_range("light " + in_quotes(light.name));
      add_light_at(Vec3f(p), std::move(light));
    }
    return true;
  }

  void add_light_at(const Vec3f& position, DraftLight&& light) {
    const double range = light.range * draft_.metres_per_unit;
    const float shorter = range < kLargestFloat ? static_cast<float>(range) : kEndlessRange;
    if (light.kind == LightKind::kPoint) {
      scene_.point_lights.push_back({.name = std::move(light.name),
                                     .position = position,
                                     .intensity = Rgb(light.power),
                                     .range = shorter});
      return;
    }
    const auto one_minus_cos = [](double angle) {
      return 2.0 * std::sin(0.5 * angle) * std::sin(0.5 * angle);
    };
    scene_.spot_lights.push_back({.name = std::move(light.name),
                                  .position = position,
                                  .intensity = Rgb(light.power),
                                  .range = shorter,
                                  .axis = normalize(light.direction),
                                  .inner_one_minus_cos = one_minus_cos(light.inner_rad),
                                  .outer_one_minus_cos = one_minus_cos(light.outer_rad)});
  }

  bool finish_cameras() {
    for (DraftCamera& camera : draft_.cameras) {
      const Vec3d eye = camera.eye * draft_.metres_per_unit;
      auto made = make_camera(std::move(camera.name), eye, camera.forward, camera.up,
                              camera.fov_y_rad, scene_.origin);
      if (!made || !in_range(eye - scene_.origin)) return out_of_range("a camera");
      if (camera.view_height > 0.0) made->projection = Projection::kOrthographic;
      if (camera.view_height > 0.0) made->view_height = camera.view_height * draft_.metres_per_unit;
      made->lens = {.radius = camera.lens_radius * draft_.metres_per_unit,
                    .focus_distance = camera.focus_distance * draft_.metres_per_unit};
      scene_.cameras.push_back(std::move(*made));
    }
    if (scene_.cameras.empty()) scene_.cameras.push_back(default_camera());
    return true;
  }

  // From the front, a little from the right and above, with all of the bounding sphere in view.
  Camera default_camera() {
    diagnostics_.warn(ImportWarningCode::kDefaultCamera,
                      "the scene names no camera: the default one frames all of it",
                      report_.root_file);
    const Vec3d lo(scene_.bounds.lo);
    const Vec3d hi(scene_.bounds.hi);
    const Vec3d centre = 0.5 * (lo + hi);
    const double distance = 0.5 * length(hi - lo) / std::sin(0.5 * kDefaultFovRad) * 1.02;
    const Vec3d towards_eye = normalize(Vec3d(0.45, 0.35, 1.0));
    return *make_camera("default", centre + distance * towards_eye, -towards_eye,
                        Vec3d(0.0, 1.0, 0.0), kDefaultFovRad, Vec3d(0.0));
  }

  bool finish_background() {
    if (draft_.background) scene_.background = Rgb(*draft_.background);
    scene_.environment = std::move(draft_.environment);
    const bool lit = !scene_.point_lights.empty() || !scene_.spot_lights.empty() ||
                     !scene_.directional_lights.empty() || any_emission() || bright_environment();
    if (lit || scene_.background != Rgb(0.0F)) return true;
    if (draft_.background || scene_.environment != nullptr) {
      diagnostics_.warn(ImportWarningCode::kNoLight,
                        "nothing in the scene gives light: the picture will be black");
      return true;
    }
    scene_.background = Rgb(kDefaultBackground);
    diagnostics_.warn(ImportWarningCode::kDefaultBackground,
                      "nothing in the scene gives light: a grey background of 0.3 and a lamp above "
                      "on the left do",
                      report_.root_file);
    add_default_lamp();
    return true;
  }

  // Three radii of the bounds away, so that every side of a model is shaded differently; scenes of
  // any size look the same.
  void add_default_lamp() {
    const Vec3d lo(scene_.bounds.lo);
    const Vec3d hi(scene_.bounds.hi);
    const Vec3d way = 1.5 * length(hi - lo) * normalize(Vec3d(-0.6, 1.0, 0.7));
    const auto intensity = static_cast<float>(kDefaultLampIrradiance * dot(way, way));
    if (!(intensity > 0.0F)) return;
    scene_.point_lights.push_back({.name = "default",
                                   .position = Vec3f(0.5 * (lo + hi) + way),
                                   .intensity = Rgb(intensity)});
  }

  [[nodiscard]] bool bright_environment() const {
    if (scene_.environment == nullptr) return false;
    const std::vector<float>& values = scene_.environment->rgb;
    return std::any_of(values.begin(), values.end(), [](float value) { return value > 0.0F; });
  }

  [[nodiscard]] bool any_emission() const {
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (used_[i] && scene_.materials[i].emission != Rgb(0.0F)) return true;
    }
    return false;
  }

  [[nodiscard]] bool in_range(const Vec3d& p) const {
    const double limit = 2.0 * diagnostics_.limits().max_coordinate;
    return std::abs(p.x) <= limit && std::abs(p.y) <= limit && std::abs(p.z) <= limit;
  }

  bool out_of_range(const std::string& what) {
    return diagnostics_.fail(ImportErrorCode::kCoordinateTooLarge,
                             "the position of " + what + " is out of range", report_.root_file);
  }

  SceneDraft& draft_;
  Diagnostics& diagnostics_;
  Scene& scene_;
  ImportReport& report_;
  Bounds3d bounds_{};
  std::vector<bool> used_;
  std::uint64_t invalid_normals_ = 0;
};

}  // namespace

bool finish_scene(SceneDraft&& draft, Diagnostics& diagnostics, Scene& scene,
                  ImportReport& report) {
  return Finisher(draft, diagnostics, scene, report).run();
}

}  // namespace raykiln::render::io
