#include "raykiln/shading/caustic_casters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "raykiln/scene/disjoint_sets.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kMostTriangles = std::size_t{1} << 20;
constexpr double kSharpExponent = 1e4;   ///< a lobe some hundredth of a radian wide
constexpr double kSharpRoughness = 0.1;  ///< alpha 0.01
constexpr double kLeastShare = 0.5;      ///< of the light that the surface meets

double largest_channel(const Rgb& c) { return static_cast<double>(std::max({c.x, c.y, c.z})); }

std::vector<std::uint32_t> triangles_that_cast(const Scene& scene) {
  std::vector<std::uint32_t> found;
  std::vector<char> casts;
  for (const Material& material : scene.materials) casts.push_back(casts_caustics(material) ? 1 : 0);
  if (std::find(casts.begin(), casts.end(), 1) == casts.end()) return found;
  for (std::uint32_t id = 0; id < scene.mesh.triangles.size(); ++id) {
    if (casts[scene.mesh.material_ids[id]] != 0) found.push_back(id);
  }
  return found;
}

/// The positions that these triangles use, ascending.
std::vector<std::uint32_t> corners_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * triangles.size());
  for (const std::uint32_t id : triangles) corners.insert(corners.end(), mesh.triangles[id].begin(), mesh.triangles[id].end());
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// Joins corners, by their number in the list, that lie in the same place.
void join_places(const TriangleMesh& mesh, const std::vector<std::uint32_t>& corners, DisjointSets& sets) {
  std::vector<std::uint32_t> by_place(corners.size());
  std::iota(by_place.begin(), by_place.end(), 0U);
  const auto place = [&](std::uint32_t i) {
    const Vec3f& p = mesh.positions[corners[i]];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  for (std::size_t i = 1; i < by_place.size(); ++i) {
    if (place(by_place[i - 1]) == place(by_place[i])) sets.join(by_place[i - 1], by_place[i]);
  }
}

/// The number of the body of each of `triangles`, from 0 on in the order of their first triangles.
std::vector<std::uint32_t> bodies_of(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> body(triangles.size(), 0);
  if (triangles.size() > kMostTriangles) return body;
  const std::vector<std::uint32_t> corners = corners_of(mesh, triangles);
  const auto number_of = [&](std::uint32_t corner) {
    return static_cast<std::uint32_t>(std::lower_bound(corners.begin(), corners.end(), corner) - corners.begin());
  };
  DisjointSets sets(corners.size());
  join_places(mesh, corners, sets);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& c = mesh.triangles[triangles[i]];
    body[i] = number_of(c[0]);
    sets.join(body[i], number_of(c[1]));
    sets.join(body[i], number_of(c[2]));
  }
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  std::vector<std::uint32_t> renumbered(corners.size(), kNone);
  std::uint32_t next = 0;
  for (std::uint32_t& b : body) {
    std::uint32_t& n = renumbered[sets.root(b)];
    if (n == kNone) n = next++;
    b = n;
  }
  return body;
}

std::vector<CausticCaster> spheres_about(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles,
                                         const std::vector<std::uint32_t>& body) {
  const std::size_t count = triangles.empty() ? 0 : std::size_t{*std::max_element(body.begin(), body.end())} + 1;
  std::vector<Bounds3f> boxes(count);
  std::vector<CausticCaster> spheres(count);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t c : mesh.triangles[triangles[i]]) boxes[body[i]].grow(mesh.positions[c]);
  }
  for (std::size_t b = 0; b < count; ++b) spheres[b].centre = 0.5 * (Vec3d(boxes[b].lo) + Vec3d(boxes[b].hi));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    CausticCaster& sphere = spheres[body[i]];
    for (const std::uint32_t c : mesh.triangles[triangles[i]]) {
      sphere.radius = std::max(sphere.radius, length(Vec3d(mesh.positions[c]) - sphere.centre));
    }
  }
  return spheres;
}

}  // namespace

bool casts_caustics(const Material& material) {
  const double mirrored = largest_channel(material.specular);
  if (material.model == SurfaceModel::kPhong) {
    return material.specular_exp >= kSharpExponent && mirrored >= kLeastShare;
  }
  return material.facets.roughness <= kSharpRoughness &&
         (mirrored >= kLeastShare || static_cast<double>(material.transparent) >= kLeastShare);
}

std::vector<CausticCaster> find_caustic_casters(const Scene& scene) {
  const std::vector<std::uint32_t> triangles = triangles_that_cast(scene);
  std::vector<CausticCaster> spheres = spheres_about(scene.mesh, triangles, bodies_of(scene.mesh, triangles));
  std::stable_sort(spheres.begin(), spheres.end(),
                   [](const CausticCaster& a, const CausticCaster& b) { return a.radius > b.radius; });
  std::vector<CausticCaster> kept;
  for (const CausticCaster& sphere : spheres) {
    const auto holds = [&](const CausticCaster& other) {
      return length(sphere.centre - other.centre) + sphere.radius <= other.radius;
    };
    if (kept.size() == kMostCasters) break;
    if (sphere.radius > 0.0 && std::none_of(kept.begin(), kept.end(), holds)) kept.push_back(sphere);
  }
  return kept;
}

}  // namespace raykiln::render
