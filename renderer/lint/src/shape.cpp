#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "checks.hpp"
#include "raykiln/math/float_bits.hpp"

namespace raykiln::render {
namespace {

constexpr double kSliver = 1e-4;
constexpr double kCoarseSteps = 16.0;

struct Shape {
  double flatness = 1.0;    ///< height over the longest edge
  double edge_steps = 0.0;  ///< shortest edge in float steps of the largest coordinate
};

double largest(const Vec3f& p) {
  const Vec3f a = glm::abs(p);
  return static_cast<double>(std::max({a.x, a.y, a.z}));
}

double float_step(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(next_up(f)) - static_cast<double>(f);
}

Shape shape_of(const TriangleMesh& mesh, std::size_t id) {
  const auto& corner = mesh.triangles[id];
  double longest = 0.0, shortest = std::numeric_limits<double>::infinity(), reach = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f &a = mesh.positions[corner[k]], &b = mesh.positions[corner[(k + 1) % 3]];
    const double edge = length(Vec3d(b) - Vec3d(a));
    longest = std::max(longest, edge);
    shortest = std::min(shortest, edge);
    reach = std::max(reach, largest(a));
  }
  const Vec3d p(mesh.positions[corner[0]]);
  const double twice_area = length(cross(Vec3d(mesh.positions[corner[1]]) - p,
                                         Vec3d(mesh.positions[corner[2]]) - p));
  return {twice_area / (longest * longest), shortest / float_step(reach)};
}

struct Worst {
  std::uint64_t count = 0;
  std::size_t id = 0;
  double value = std::numeric_limits<double>::infinity();
  void see(double x, double limit, std::size_t triangle) {
    if (!(x < limit)) return;
    ++count;
    if (x < value) {
      value = x;
      id = triangle;
    }
  }
};

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

}  // namespace

void check_shapes(const Scene& scene, Findings& findings) {
  Worst sliver, coarse;
  for (std::size_t id = 0; id < scene.mesh.triangles.size(); ++id) {
    const Shape shape = shape_of(scene.mesh, id);
    sliver.see(shape.flatness, kSliver, id);
    coarse.see(shape.edge_steps, kCoarseSteps, id);
  }
  if (sliver.count > 0) {
    findings.push_back({LintLevel::kWarning, "sliver_triangles",
                        "triangles are thinner than 1/10000 of their length; the thinnest: " +
                            number(sliver.value),
                        "triangle " + std::to_string(sliver.id), sliver.count});
  }
  if (coarse.count > 0) {
    findings.push_back({LintLevel::kWarning, "coarse_edges",
                        "edges are shorter than 16 steps of their single-precision coordinates; the "
                        "shortest: " + number(coarse.value) + " steps",
                        "triangle " + std::to_string(coarse.id), coarse.count});
  }
}

}  // namespace raykiln::render
