#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "checks.hpp"
#include "raykiln/scene/disjoint_sets.hpp"

namespace raykiln::render {
namespace {

bool refracts(const Material& m) {
  if (m.model == SurfaceModel::kMicrofacet) {
    return m.transparent > 0.0F && !m.facets.thin && m.index_of_refraction != 1.0F;
  }
  return m.transparent > 0.0F && m.specular != Rgb(0.0F) && m.index_of_refraction != 1.0F;
}

/// One side of a triangle, from the lower to the higher corner.
struct Edge {
  std::uint32_t low, high, triangle;
  bool forward;  ///< the triangle goes from low to high
  [[nodiscard]] auto key() const { return std::tie(low, high); }
};

/// Corners with equal positions get equal numbers. Sorting, not hashing: -0 and +0 are equal.
std::vector<std::uint32_t> joined_corners(const std::vector<Vec3f>& positions) {
  std::vector<std::uint32_t> order(positions.size()), joined(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) {
    const Vec3f& p = positions[i];
    return std::make_tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    joined[order[i]] = same ? joined[order[i - 1]] : order[i];
  }
  return joined;
}

/// The refracting surface of one material.
class Glass {
 public:
  Glass(const TriangleMesh& mesh, std::vector<std::uint32_t> ids)
      : mesh_(mesh), ids_(std::move(ids)), bodies_(ids_.size()), flawed_(ids_.size(), false) {}

  std::uint64_t open = 0, crowded = 0, against = 0, inside_out = 0;

  void look(const std::vector<std::uint32_t>& joined) {
    const auto edges = sorted_edges(joined);
    for (std::span<const Edge> rest(edges); !rest.empty();) {
      const auto differs = std::find_if(rest.begin(), rest.end(), [&rest](const Edge& edge) {
        return edge.key() != rest.front().key();
      });
      const auto alike = static_cast<std::size_t>(differs - rest.begin());
      judge(rest.first(alike));
      rest = rest.subspan(alike);
    }
    measure_volumes();
  }

 private:
  std::vector<Edge> sorted_edges(const std::vector<std::uint32_t>& joined) const {
    std::vector<Edge> edges;
    for (std::uint32_t k = 0; k < ids_.size(); ++k) {
      const auto& corner = mesh_.triangles[ids_[k]];
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t a = joined[corner[side]], b = joined[corner[(side + 1) % 3]];
        edges.push_back({std::min(a, b), std::max(a, b), k, a < b});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return x.key() < y.key(); });
    return edges;
  }

  /// All triangles that meet at one edge.
  void judge(std::span<const Edge> edges) {
    for (const Edge& edge : edges) bodies_.join(edges.front().triangle, edge.triangle);
    const std::size_t n = edges.size();
    const bool twisted = n == 2 && edges.front().forward == edges.back().forward;
    open += n == 1 ? 1 : 0;
    crowded += n > 2 ? 1 : 0;
    against += twisted ? 1 : 0;
    if (n == 2 && !twisted) return;
    for (const Edge& edge : edges) flawed_[edge.triangle] = true;
  }

  // Six times the signed volume (divergence theorem), about a corner of the body itself.
  void measure_volumes() {
    struct Body {
      double volume = 0.0;
      bool flawed = false;
    };
    std::map<std::uint32_t, Body> bodies;
    for (std::uint32_t k = 0; k < ids_.size(); ++k) {
      const std::uint32_t root = bodies_.root(k);
      const Vec3d about(mesh_.positions[mesh_.triangles[ids_[root]][0]]);
      const auto& corner = mesh_.triangles[ids_[k]];
      const auto at = [&](std::size_t i) { return Vec3d(mesh_.positions[corner[i]]) - about; };
      Body& body = bodies[root];
      body.volume += dot(at(0), cross(at(1), at(2)));
      body.flawed = body.flawed || flawed_[k];
    }
    for (const auto& [root, body] : bodies) inside_out += !body.flawed && body.volume < 0.0 ? 1 : 0;
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> ids_;  ///< of the triangles
  DisjointSets bodies_;                     ///< connected over edges; by place in ids_
  std::vector<bool> flawed_;        ///< has an edge that is not between two triangles wound alike
};

void report(const Glass& glass, const std::string& where, Findings& findings) {
  const auto add = [&](std::uint64_t count, const char* code, const char* message) {
    if (count > 0) findings.push_back({LintLevel::kError, code, message, where, count});
  };
  add(glass.open, "open_glass",
      "edges of a refracting body belong to one triangle: light enters it and never leaves, or the "
      "other way round; give a pane two faces");
  add(glass.crowded, "crowded_glass",
      "edges of a refracting body belong to more than two triangles: inside and outside are not told "
      "apart");
  add(glass.against, "twisted_glass",
      "neighbouring triangles of a refracting body are wound against each other: one of them takes "
      "the inside for the outside");
  add(glass.inside_out, "inside_out_glass",
      "closed refracting bodies have normals that face inwards: glass around, vacuum inside; right "
      "only for bubbles");
}

}  // namespace

void check_glass(const Scene& scene, Findings& findings) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_material;
  for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
    const std::uint32_t m = scene.mesh.material_ids[t];
    if (refracts(scene.materials[m])) by_material[m].push_back(t);
  }
  if (by_material.empty()) return;
  const auto joined = joined_corners(scene.mesh.positions);
  for (auto& [material, ids] : by_material) {
    Glass glass(scene.mesh, std::move(ids));
    glass.look(joined);
    report(glass, "material \"" + scene.materials[material].name + '"', findings);
  }
}

}  // namespace raykiln::render
