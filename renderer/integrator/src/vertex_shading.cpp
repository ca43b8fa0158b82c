#include "vertex_shading.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/shading/surface_point.hpp"

namespace raykiln::render {
namespace {

struct Vertex {
  std::uint32_t id;  ///< of the triangle
  bool transmits;    ///< light from behind comes through
  SurfacePoint point;
  Bsdf bsdf;
  VertexKey key;
};

bool finite(const Rgbd& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}
bool zero(const Rgb& c) { return c == Rgb(0.0F); }

/// Ends a path with probability 1 - p and multiplies what goes on by 1/p, where p is its throughput
/// so far. The part of the throughput that is a change of medium is left out of p: inside glass of
/// index n radiance is n^2 times larger, on the way from the camera throughput n^2 times smaller,
/// and such a path is worth no less. What goes on has a throughput of `scale`, so weights stay bounded.
bool survives_roulette(PathState& path, const VertexKey& key) {
  if (path.bounce <= static_cast<std::uint32_t>(kBouncesBeforeRoulette)) return true;
  const Rgbd& t = path.throughput;
  const double p = std::max({t.x, t.y, t.z}) / path.scale;
  if (!(p < 1.0)) return true;  // also what is not finite: it is counted further on
  if (uniform(key, Dimension::kRoulette) >= p) return false;
  path.throughput /= p;
  return true;
}

/// Signed height of `light` over the plane of triangle `id`; 0 when it lies in it as far as doubles
/// can tell, for then the sign is that of a rounding error. Differences of floats are exact in double
/// or nearly so: a light one float step off an axis-parallel plane is never taken for one in it.
double height_over(const TriangleMesh& mesh, std::uint32_t id, const Vec3d& ng, const Vec3d& light) {
  const Vec3d way = light - Vec3d(mesh.positions[mesh.triangles[id][0]]);
  const double height = dot(ng, way);
  return std::abs(height) <= 0x1p-50 * dot(abs(ng), abs(way)) ? 0.0 : height;
}

/// Density over solid angle of a density over area, seen over `distance2` under `cosine`.
double solid_angle_pdf(double pdf_area, double distance2, double cosine) {
  return pdf_area * distance2 / cosine;
}

class VertexShader {
 public:
  VertexShader(const TransportScene& scene, const PathSettings& settings, const PathState& state,
               ShadingSinks& sinks)
      : scene_(scene), settings_(settings), state_(state), sinks_(sinks) {}

  /// Emission seen by the path itself, weighted against its being found by a shadow ray.
  void add_emission(const SurfacePoint& point, const Rgb& radiance, const Ray& ray, float t) {
    if (zero(radiance)) return;
    double weight = 1.0;
    if (state_.bounce > 0 && settings_.emitter_sampling && scene_.emitters.has_triangles()) {
      const Vec3d d(ray.d);
      const double distance2 = static_cast<double>(t) * static_cast<double>(t) * dot(d, d);
      const double other = solid_angle_pdf(scene_.emitters.pdf_area(radiance), distance2,
                                           std::abs(dot(point.ng, d)));
      weight = power_heuristic(state_.pdf, other);
    }
    sinks_.results[state_.slot].emitted += state_.throughput * Rgbd(radiance) * weight;
  }

  /// Point lights: I cos / r^2 times f, all of them, as the seed goes through them.
  void light_from_points(const Vertex& vertex) {
    for (const PointLight& light : scene_.emitters.point_lights()) {
      if (sinks_.stopped) return;
      const Vec3d way = Vec3d(light.position) - vertex.point.p;
      const double distance2 = dot(way, way);
      if (!(distance2 > 0.0)) {
        ++sinks_.stats.lights_at_hits;
        continue;
      }
      if (!faces(vertex, Vec3d(light.position))) continue;
      const Vec3d wi = way / std::sqrt(distance2);
      const BsdfValue value = evaluate(vertex.bsdf, Vec3f(wi));
      const Rgbd arriving = Rgbd(light.intensity) / distance2;
      queue({ray_origin(vertex.point, wi), light.position, ShadowEnd::kPointLight},
            state_.throughput * value.f_cos * arriving);
    }
  }

  /// One point on an emitting triangle, weighted against the path's own rays finding it.
  void light_from_emitters(const Vertex& vertex) {
    const EmitterSample sample = scene_.emitters.sample(scene_.scene, vertex.key);
    const Vec3d way = sample.point.p - vertex.point.p;
    const double distance2 = dot(way, way);
    const Vec3d wi = way / std::sqrt(distance2);
    const double cosine = std::abs(dot(sample.point.ng, wi));
    if (!(distance2 > 0.0 && cosine > 0.0)) return;
    const double pdf = solid_angle_pdf(sample.pdf_area, distance2, cosine);
    const BsdfValue value = evaluate(vertex.bsdf, Vec3f(wi));
    if (value.f_cos == Rgbd(0.0)) return;
    const double weight = power_heuristic(pdf, settings_.branches * value.pdf) / pdf;
    const Vec3f from = ray_origin(vertex.point, wi);
    queue({from, ray_end(sample.point, Vec3d(from)), ShadowEnd::kSurface},
          state_.throughput * value.f_cos * sample.radiance * weight);
  }

  /// The rays that go on from here.
  void scatter(const Vertex& vertex) {
    const auto branches = static_cast<std::uint64_t>(settings_.branches);
    for (std::uint64_t k = 0; k < branches; ++k) {
      PathState child = state_;
      child.node = state_.node * branches + k;
      child.bounce = state_.bounce + 1;
      const VertexKey key =
          branches == 1 ? vertex.key : vertex_key(state_.key, child.node, state_.bounce);
      const BsdfSample sample = sample_bsdf(vertex.bsdf, key);
      if (sample.lobe == Lobe::kNone) continue;
      child.throughput *= sample.weight / static_cast<double>(branches);
      child.scale *= sample.radiance_scale / static_cast<double>(branches);
      child.pdf = sample.pdf * static_cast<double>(branches);
      if (settings_.bsdf.light.roulette && !survives_roulette(child, key)) {
        ++sinks_.stats.roulette_ends;
        continue;
      }
      if (!finite(child.throughput)) {
        // Poisons the sample, which is then dropped, counted and located: never a silent black.
        sinks_.results[state_.slot].emitted += child.throughput;
        continue;
      }
      Ray ray;
      ray.o = ray_origin(vertex.point, Vec3d(sample.wi));
      ray.d = sample.wi;
      sinks_.next.push(ray, child);
    }
  }

 private:
  /// Can a light at this place light the surface? Decided in double: the floats in which values are
  /// computed give a light within 1e-7 of the plane's direction the side of a rounding error.
  bool faces(const Vertex& vertex, const Vec3d& light) const {
    const double height = height_over(scene_.scene.mesh, vertex.id, vertex.point.ng, light);
    if (height == 0.0) return false;
    const bool viewed_from_front = dot(Vec3d(vertex.bsdf.ng), vertex.point.ng) > 0.0;
    return vertex.transmits || (height > 0.0) == viewed_from_front;
  }

  struct ShadowWay {
    Vec3f from, to;
    ShadowEnd end;
  };
  void queue(const ShadowWay& way, const Rgbd& light) {
    if (light == Rgbd(0.0)) return;
    sinks_.shadows.push(way.from, way.to, way.end, light, state_.slot);
    if (sinks_.shadows.full()) {
      sinks_.shadows.flush(scene_.tree, settings_.traversal, sinks_.results, sinks_.stats);
      sinks_.stopped = sinks_.stop.stop_requested();
    }
  }

  const TransportScene& scene_;
  const PathSettings& settings_;
  const PathState& state_;
  ShadingSinks& sinks_;
};

}  // namespace

// L_o = L_e + sum over lights of f L cos + the scattered rays. A shadow ray to an emitter stands for
// one more reflection, so it is sent only where such a ray may be; point lights, which no ray can
// find, are added at every hit.
void shade_vertex(const TransportScene& scene, const PathSettings& settings, const Ray& ray,
                  const PathState& state, const Hit& hit, ShadingSinks& sinks) {
  VertexShader shader(scene, settings, state, sinks);
  if (hit.id == kNoHit) {
    sinks.results[state.slot].emitted += state.throughput * Rgbd(scene.scene.background);
    return;
  }
  const SurfacePoint point =
      surface_point(scene.scene.mesh, hit.id, static_cast<double>(hit.u), static_cast<double>(hit.v));
  const Material& material = scene.scene.materials[point.material];
  shader.add_emission(point, material.emission, ray, hit.t);
  if (zero(material.diffuse) && zero(material.specular)) return;

  const Vertex vertex{
      hit.id, material.transparent > 0.0F, point, make_bsdf(material, Vec3f(point.ng), point.ns, -ray.d, settings.bsdf),
      vertex_key(state.key, state.node, state.bounce)};
  shader.light_from_points(vertex);
  if (state.bounce >= static_cast<std::uint32_t>(settings.max_depth)) {
    sinks.results[state.slot].truncated = true;
    return;
  }
  if (settings.emitter_sampling && scene.emitters.has_triangles()) {
    shader.light_from_emitters(vertex);
  }
  shader.scatter(vertex);
}

}  // namespace raykiln::render
