// The shading of one vertex, as a template over the parts of the code that are needed.
// Included by the files that make an instance of it, and by no other.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "axis_group.hpp"
#include "leave_out.hpp"
#include "matte_group.hpp"
#include "raykiln/shading/environment_light.hpp"
#include "raykiln/shading/matte_bsdf.hpp"
#include "raykiln/shading/punctual_light.hpp"
#include "raykiln/shading/surface_point.hpp"
#include "raykiln/shading/texture_lookup.hpp"
#include "rich_bsdf.hpp"
#include "roulette.hpp"
#include "vertex_shading.hpp"

namespace raykiln::render {

template <Switches kSwitches>
using LobesOf = std::conditional_t<
    kSwitches.rich, RichBsdf,
    std::conditional_t<!kSwitches.specular, MatteBsdf<kSwitches.normals>,
                       std::conditional_t<kSwitches.transmission, Bsdf, OpaqueBsdf>>>;

template <class Lobes>
struct Vertex {
  std::uint32_t id;  ///< of the triangle
  bool transmits;    ///< light from behind comes through
  SurfacePoint point;
  Lobes bsdf;
  VertexKey key;
};

inline bool finite(const Rgbd& c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}
inline bool zero(const Rgb& c) { return c == Rgb(0.0F); }

/// Cosine of a direction over the plane of normal `ng`, times its length; 0 when it lies in it as far as doubles can
/// tell.
inline double cosine_over(const Vec3d& ng, const Vec3d& direction) {
  const double cosine = dot(ng, direction);
  return std::abs(cosine) <= 0x1p-50 * dot(abs(ng), abs(direction)) ? 0.0 : cosine;
}

/// Signed height of `light` over the plane of triangle `id`; 0 when it lies in it as far as doubles
/// can tell, for then the sign is that of a rounding error. Differences of floats are exact in
/// double or nearly so: a light one float step off an axis-parallel plane is never taken for one in
/// it.
inline double height_over(const TriangleMesh& mesh, std::uint32_t id, const Vec3d& ng,
                          const Vec3d& light) {
  return cosine_over(ng, light - Vec3d(mesh.positions[mesh.triangles[id][0]]));
}

/// Density over solid angle of a density over area, seen over `distance2` under `cosine`.
inline double solid_angle_pdf(double pdf_area, double distance2, double cosine) {
  return pdf_area * distance2 / cosine;
}

/// One vertex of a path, shaded with what `kSwitches` leaves in the code.
template <Switches kSwitches>
class VertexShader {
 public:
  using Lobes = LobesOf<kSwitches>;
  using Vertex = render::Vertex<Lobes>;

  /// `origin`: where the path comes from, if emitters are drawn from a tree; `cone`: what its pixel covers, if
  /// textures are read by that; else null.
  VertexShader(const Transport& transport, const PathState& state, const EmitterReceiver* origin,
               ShadingSinks& sinks, const PathCone* cone = nullptr)
      : scene_(transport), settings_(transport.settings), state_(state), origin_(origin), sinks_(sinks), cone_(cone) {}

  // L_o = L_e + sum over lights of f L cos + the scattered rays. A shadow ray to an emitter
  // or the environment stands for one more reflection, so it is sent only where such a ray may be;
  // lights without a surface, which no ray can find, are added at every hit.
  void shade(const Ray& ray, const Hit& hit) {
    if (hit.id == kNoHit) {
      sinks_.results[state_.slot].emitted += state_.throughput * Rgbd(scene_.background);
      if (scene_.environment != nullptr) add_environment(ray);
      return;
    }
    SurfacePoint point =
        surface_point(scene_.mesh, hit.id, static_cast<double>(hit.u), static_cast<double>(hit.v),
                      kSwitches.normals && scene_.normals);
    const TrianglePlace place = covered_place(ray, hit);
    const Material& material = material_at(point, place);
    if constexpr (kSwitches.rich) {
      if (scene_.textures != nullptr) {
        const auto bent = mapped_normal(*scene_.textures, scene_.mesh, point.material, place, point.ns);
        if (bent) point.ns = *bent;
      }
      if (!zero(material.facets.absorption) && dot(point.ng, Vec3d(ray.d)) > 0.0) {
        PathState dimmed = state_;
        dimmed.throughput *= let_through(material, ray, hit.t);
        VertexShader further(scene_, dimmed, origin_, sinks_, cone_);
        further.covered_ = covered_;
        return further.shade_surface(ray, hit, point, material);
      }
    }
    shade_surface(ray, hit, point, material);
  }

 private:
  void shade_surface(const Ray& ray, const Hit& hit, const SurfacePoint& point,
                     const Material& material) {
    add_emission(point, material.emission, ray, hit);
    if (!returns_light(material)) return;
    if (kSwitches.reduced && state_.bounce > 0 && leaves_out(Effect::kIndirectLight)) return;
    const bool last = !kSwitches.bounces || state_.bounce >= settings_.max_depth;
    if (last) sinks_.results[state_.slot].truncated = scene_.has_light;
    if (last && !scene_.has_lights_without_surface()) return;

    const Vertex vertex{hit.id, transmits(material), point, lobes(material, point, -ray.d),
                        kSwitches.bounces && !last
                            ? vertex_key(state_.key, state_.node, state_.bounce)
                            : VertexKey{}};
    light_from_points(vertex);
    if (last) return;
    look_for_casters(vertex);
    if (settings_.emitter_sampling) light_from_emitters(vertex);
    if (scene_.environment_sampling) light_from_environment(vertex);
    scatter(vertex);
  }

  static bool returns_light(const Material& material) {
    if constexpr (kSwitches.rich) return scatters(material);
    return !(zero(material.diffuse) && zero(material.specular));
  }

  /// Beer and Lambert: what is left of light that came from behind the surface, through the body.
  static Rgbd let_through(const Material& material, const Ray& ray, float t) {
    const double way = static_cast<double>(t) * length(Vec3d(ray.d));
    return glm::exp(-way * Rgbd(material.facets.absorption));
  }

  /// The place of the hit, with what the path's pixel covers of the triangle. Slanting counts for nothing: it makes
  /// what is covered longer, never less wide.
  TrianglePlace covered_place(const Ray& ray, const Hit& hit) {
    TrianglePlace place = place_of(hit);
    if (!kSwitches.rich || cone_ == nullptr) return place;
    covered_ = cone_->width + cone_->spread * static_cast<double>(hit.t) * length(Vec3d(ray.d));
    const auto& corner = scene_.mesh.triangles[hit.id];
    const Vec3d p(scene_.mesh.positions[corner[0]]);
    const Vec3d twice_area = cross(Vec3d(scene_.mesh.positions[corner[1]]) - p, Vec3d(scene_.mesh.positions[corner[2]]) - p);
    place.pyramids = scene_.pyramids;
    place.footprint = covered_ * covered_ / length(twice_area);
    return place;
  }

  const Material& material_at(const SurfacePoint& point, const TrianglePlace& place) {
    const Material& material = scene_.scene.materials[point.material];
    if (!kSwitches.rich || scene_.textures == nullptr) return material;
    paint(*scene_.textures, material, point.material, place, sinks_.painted);
    return sinks_.painted;
  }

  Lobes lobes(const Material& material, const SurfacePoint& point, const Vec3f& wo) const {
    const Vec3f ng(point.ng);
    if constexpr (kSwitches.rich) {
      return rich_lobes(material, point, ng, wo);
    } else if constexpr (!kSwitches.specular) {
      return make_matte_bsdf<kSwitches.normals>(material, ng, point.ns, wo, settings_.bsdf);
    } else if constexpr (!kSwitches.transmission) {
      return make_opaque_bsdf(material, ng, point.ns, wo, settings_.bsdf);
    } else {
      return make_bsdf(material, ng, point.ns, wo, settings_.bsdf);
    }
  }

  RichBsdf rich_lobes(const Material& material, const SurfacePoint& point, const Vec3f& ng,
                      const Vec3f& wo) const {
    const bool caustic =
        kSwitches.reduced && state_.met_diffuse && leaves_out(Effect::kCaustics);
    if (material.model == SurfaceModel::kPhong) {
      Bsdf bsdf = make_bsdf(material, ng, point.ns, wo, settings_.bsdf);
      if constexpr (kSwitches.reduced) leave_out(bsdf, material, settings_.left_out, caustic);
      return RichBsdf(bsdf);
    }
    if constexpr (kSwitches.reduced) {
      MicrofacetBsdf bsdf = make_microfacet_bsdf(material, ng, point.ns, wo, settings_.bsdf);
      leave_out(bsdf, settings_.left_out, caustic);
      return RichBsdf(bsdf);
    } else {
      return RichBsdf(make_microfacet_bsdf(material, ng, point.ns, wo, settings_.bsdf));
    }
  }

  /// Emission seen by the path itself, weighted against its being found by a shadow ray.
  void add_emission(const SurfacePoint& point, const Rgb& radiance, const Ray& ray, const Hit& hit) {
    if (zero(radiance)) return;
    if (kSwitches.reduced && leaves_out(Effect::kAreaEmitters)) return;
    double weight = 1.0;
    if (state_.bounce > 0 && settings_.emitter_sampling) {
      const Vec3d d(ray.d);
      const auto t = static_cast<double>(hit.t);
      const double pdf_area = origin_ == nullptr
                                  ? scene_.emitters.pdf_area(point.material)
                                  : scene_.emitters.pdf_area(scene_.scene, hit.id, *origin_);
      const double other = solid_angle_pdf(pdf_area, t * t * dot(d, d), std::abs(dot(point.ng, d)));
      weight = power_heuristic(state_.pdf, other);
    }
    sinks_.results[state_.slot].emitted += state_.throughput * Rgbd(radiance) * weight;
  }

  /// Environment seen by the path itself, weighted against its being found by a shadow ray.
  void add_environment(const Ray& ray) {
    const EnvironmentLight::Seen seen = scene_.environment->towards(Vec3d(ray.d));
    const bool found_twice = state_.bounce > 0 && scene_.environment_sampling;
    const double weight = found_twice ? power_heuristic(state_.pdf, seen.pdf) : 1.0;
    sinks_.results[state_.slot].emitted += state_.throughput * seen.radiance * weight;
  }

  /// Light at a place: I cos / r^2 times f and what range and cone leave of it.
  template <class Light>
  void light_from_place(const Vertex& vertex, const Light& light) {
    if (sinks_.stopped) return;
    const Vec3d way = Vec3d(light.position) - vertex.point.p;
    const double distance2 = dot(way, way);
    if (!(distance2 > 0.0)) {
      ++sinks_.stats.lights_at_hits;
      return;
    }
    if (!faces(vertex, Vec3d(light.position))) return;
    const Vec3d wi = way / std::sqrt(distance2);
    Rgbd arriving = Rgbd(light.intensity) / distance2;
    if (light.range < kEndlessRange) arriving *= range_share(distance2, light.range);
    if constexpr (std::is_same_v<Light, SpotLight>) arriving *= cone_share(light, -wi);
    if (arriving == Rgbd(0.0)) return;
    const BsdfValue value = evaluate(vertex.bsdf, Vec3f(wi));
    add_unfindable({ray_origin(vertex.point, wi), light.position, ShadowEnd::kPointLight, vertex.id},
                   state_.throughput * value.f_cos * arriving);
  }

  void light_along(const Vertex& vertex, const DirectionalLight& light) {
    if (sinks_.stopped) return;
    const Vec3d wi = -light.direction;
    if (!on_lit_side(vertex, cosine_over(vertex.point.ng, wi))) return;
    const BsdfValue value = evaluate(vertex.bsdf, Vec3f(wi));
    add_unfindable({ray_origin(vertex.point, wi), Vec3f(wi), ShadowEnd::kInfinity, vertex.id},
                   state_.throughput * value.f_cos * Rgbd(light.irradiance));
  }

  /// Lights without a surface: all of them, as the seed goes through its point lights.
  void light_from_points(const Vertex& vertex) {
    for (const PointLight& light : scene_.point_lights) light_from_place(vertex, light);
    for (const SpotLight& light : scene_.spot_lights) light_from_place(vertex, light);
    for (const DirectionalLight& light : scene_.directional_lights) light_along(vertex, light);
  }

  /// The bodies towards which this surface draws directions, too.
  void look_for_casters(const Vertex& vertex) {
    if (scene_.casters.empty() || state_.bounce > kLastCasterBounce) return;
    const double part = diffuse_part(vertex.bsdf);
    if (!(part > 0.0)) return;
    see_casters(sinks_.seen, scene_.casters, vertex.point.p, Vec3d(vertex.bsdf.ng), part);
    seen_ = &sinks_.seen;
  }
  /// The density with which scatter() finds a direction of this value.
  [[nodiscard]] double found_pdf(const Vec3d& wi, const BsdfValue& value) const {
    return seen_ == nullptr ? value.pdf : mixed_pdf(*seen_, Vec3f(wi), value.pdf);
  }

  /// Can a mirror or a clear border send on light of an emitter's point at all? Nearly always not, and then neither
  /// is a point drawn: value.f_cos would be 0.
  bool light_may_come(const Vertex& vertex) const {
    if constexpr (kSwitches.rich || !kSwitches.specular) {
      return true;
    } else {
      const Lobes& b = vertex.bsdf;
      if (!scatters_along_axes_alone(b)) return true;
      const auto along = [&](const Vec3f& axis) { return scene_.emitters.may_lie_along(vertex.point.p, axis, kAxisWidth); };
      return along(b.mirror) || (vertex.transmits && along(b.refracted));
    }
  }

  /// One point on an emitting triangle, weighted against the path's own rays finding it.
  void light_from_emitters(const Vertex& vertex) {
    if (!light_may_come(vertex)) return;
    const EmitterSample sample =
        scene_.emitters_by_tree
            ? scene_.emitters.sample(scene_.scene, vertex.key, receiver(vertex))
            : scene_.emitters.sample(scene_.scene, vertex.key);
    if (!(sample.pdf_area > 0.0)) return;
    const Vec3d way = sample.point.p - vertex.point.p;
    const double distance2 = dot(way, way);
    const Vec3d wi = way / std::sqrt(distance2);
    const double cosine = std::abs(dot(sample.point.ng, wi));
    if (!(distance2 > 0.0 && cosine > 0.0)) return;
    const double pdf = solid_angle_pdf(sample.pdf_area, distance2, cosine);
    const BsdfValue value = evaluate(vertex.bsdf, Vec3f(wi));
    if (value.f_cos == Rgbd(0.0)) return;
    const double weight = power_heuristic(pdf, settings_.branches * found_pdf(wi, value)) / pdf;
    Rgbd radiance = sample.radiance;
    if (kSwitches.rich && scene_.textures != nullptr) {
      radiance *= emission_factor(*scene_.textures, sample.point.material,
                                  {sample.triangle, sample.u, sample.v});
    }
    if (scene_.gaps.any()) {
      radiance *= scene_.gaps.met({sample.triangle, sample.u, sample.v}, wi);
    }
    const Vec3f from = ray_origin(vertex.point, wi);
    queue({from, ray_end(sample.point, Vec3d(from)), ShadowEnd::kSurface, vertex.id, sample.triangle},
          state_.throughput * value.f_cos * radiance * weight);
  }

  /// Rounded to float before anything is drawn for it: what asks for the density later has the same.
  static EmitterReceiver receiver(const Vertex& vertex) {
    return {Vec3f(vertex.point.p), Vec3f(vertex.bsdf.ng), vertex.transmits};
  }

  /// One direction to the environment, weighted against the path's own rays finding it.
  void light_from_environment(const Vertex& vertex) {
    const EnvironmentSample sample = scene_.environment->sample(vertex.key);
    const Vec3f wi(sample.wi);
    const BsdfValue value = evaluate(vertex.bsdf, wi);
    if (value.f_cos == Rgbd(0.0)) return;
    const double weight =
        power_heuristic(sample.pdf, settings_.branches * found_pdf(sample.wi, value)) / sample.pdf;
    queue({ray_origin(vertex.point, sample.wi), wi, ShadowEnd::kInfinity, vertex.id},
          state_.throughput * value.f_cos * sample.radiance * weight);
  }

  /// The rays that go on from here.
  void scatter(const Vertex& vertex) {
    const auto branches = static_cast<std::uint64_t>(settings_.branches);
    for (std::uint64_t k = 0; k < branches; ++k) {
      PathState child = state_;
      child.node = state_.node * branches + k;
      child.bounce = static_cast<std::uint16_t>(state_.bounce + 1);
      const VertexKey key =
          branches == 1 ? vertex.key : vertex_key(state_.key, child.node, state_.bounce);
      const BsdfSample sample =
          seen_ == nullptr ? sample_bsdf(vertex.bsdf, key) : sample_mixture(vertex.bsdf, *seen_, key);
      if (sample.lobe == Lobe::kNone) continue;
      if constexpr (kSwitches.reduced) child.met_diffuse |= sample.lobe == Lobe::kDiffuse;
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
      if (scene_.emitters_by_tree) {
        sinks_.next.push(ray, child, vertex.id, receiver(vertex));
      } else {
        sinks_.next.push(ray, child, vertex.id);
      }
      if (kSwitches.rich && cone_ != nullptr) sinks_.next.cones.push_back({covered_, cone_->spread + spread_by(sample.pdf)});
    }
  }

  /// What a lobe adds to a cone: a quarter of its width, for 1/pdf is about its solid angle. Mirrors add nothing.
  static double spread_by(double pdf) { return pdf > 0.0 ? 0.25 / std::sqrt(pdf) : 0.0; }

  /// Can a light at this place light the surface? Decided in double: the floats in which values are
  /// computed give a light within 1e-7 of the plane's direction the side of a rounding error.
  bool faces(const Vertex& vertex, const Vec3d& light) const {
    const double height = height_over(scene_.mesh, vertex.id, vertex.point.ng, light);
    return on_lit_side(vertex, height);
  }
  bool on_lit_side(const Vertex& vertex, double height) const {
    if (height == 0.0) return false;
    const bool viewed_from_front = dot(Vec3d(vertex.bsdf.ng), vertex.point.ng) > 0.0;
    return vertex.transmits || (height > 0.0) == viewed_from_front;
  }

  /// Light that arrives if nothing is in the way; where shadows are left out, in any case.
  void add_unfindable(const ShadowQueue::Way& way, const Rgbd& light) {
    if (light == Rgbd(0.0)) return;
    if (kSwitches.reduced && leaves_out(Effect::kPointLightShadows)) {
      sinks_.results[state_.slot].emitted += light;
    } else {
      queue(way, light);
    }
  }
  void queue(const ShadowQueue::Way& way, const Rgbd& light) {
    if (light == Rgbd(0.0)) return;
    sinks_.shadows.push(way, light, state_.slot);
    if (sinks_.shadows.full()) {
      sinks_.shadows.flush(scene_.tree, settings_.traversal, sinks_.results, sinks_.stats,
                           scene_.gaps);
      sinks_.stopped = sinks_.stop.stop_requested();
    }
  }

  [[nodiscard]] bool leaves_out(Effect effect) const { return settings_.left_out.contains(effect); }

  const Transport& scene_;
  const PathSettings& settings_;
  const PathState& state_;
  const EmitterReceiver* origin_;
  ShadingSinks& sinks_;
  const PathCone* cone_;
  const CasterCones* seen_ = nullptr;  ///< where directions are drawn towards casters, too
  double covered_ = 0.0;  ///< width of what the path's pixel covers here, metres
};

template <Switches kSwitches>
void shade_range(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  const PathStream& front = range.front;
  const std::span<const PathState> states = front.states();
  const auto shade_one = [&](std::size_t i) {
    const EmitterReceiver* origin = transport.emitters_by_tree ? &front.origins[i] : nullptr;
    const PathCone* cone = kSwitches.rich && transport.pyramids != nullptr ? &front.cones[i] : nullptr;
    VertexShader<kSwitches>(transport, states[i], origin, sinks, cone).shade(front.rays()[i], range.hits[i - range.begin]);
  };
  constexpr bool kGroups = kSwitches.bounces && !kSwitches.reduced;
  constexpr bool kAxes = kGroups && kSwitches.specular;
  const auto shade_axes = [&] {
    for (const std::uint32_t left : range.axes.shade(transport, range, sinks)) {
      if (!sinks.stopped) shade_one(range.begin + left);
    }
  };
  for (std::size_t i = range.begin; i < range.end && !sinks.stopped; ++i) {
    (states[i].bounce == 0 ? sinks.stats.camera_rays : sinks.stats.bounce_rays) += 1;
    const Hit& hit = range.hits[i - range.begin];
    if (kGroups && range.mattes.takes(hit, states[i])) {
      range.mattes.add(i, transport, range, sinks);
    } else if (kAxes && range.axes.takes(hit, states[i])) {
      if (range.axes.add(i - range.begin)) shade_axes();
    } else {
      shade_one(i);
    }
  }
  if (kAxes) shade_axes();
  range.mattes.shade(transport, range, sinks);
}

}  // namespace raykiln::render
