#include "matte_group.hpp"

#include <algorithm>

#include "lane_choice.hpp"
#include "raykiln/shading/caster_cones.hpp"
#include "raykiln/shading/punctual_light.hpp"
#include "vertex_batch.hpp"

namespace raykiln::render {
namespace {

/// Beyond, tables that are made once a task would cost more than they save.
constexpr std::size_t kMostMaterials = 4096;
constexpr std::size_t kMostLights = 255;
constexpr std::size_t kBatch = 256;
constexpr std::size_t kBatchShadows = 4096;  ///< shadow rays of a batch

/// Is everything that these settings ask for at such a vertex in the kernel?
bool covers(const Transport& t) {
  const PathSettings& s = t.settings;
  return s.branches == 1 && s.max_depth > 0 && (s.left_out - EffectSet{Effect::kWatertightTriangles}).empty() &&
         s.bsdf.direction_sampling == DirectionSampling::kBsdf &&
         s.bsdf.light.diffuse_sampling == DiffuseSampling::kCosine && t.environment == nullptr &&
         t.textures == nullptr && !t.gaps.any() && t.spot_lights.empty() && t.directional_lights.empty() &&
         t.point_lights.size() <= kMostLights && t.scene.materials.size() <= kMostMaterials;
}

bool plain(const Material& m) {
  const Rgb black(0.0F);
  return m.model == SurfaceModel::kPhong && m.diffuse != black && m.specular == black && m.transparent == 0.0F &&
         m.emission == black && m.facets.absorption == black;
}

LaneDraw draw_from_tree(const void* tree, const LaneReceiver& receiver, double u) {
  const EmitterReceiver at{Vec3f(receiver.p[0], receiver.p[1], receiver.p[2]),
                           Vec3f(receiver.normal[0], receiver.normal[1], receiver.normal[2]),
                           receiver.both_sides};
  const auto drawn = static_cast<const EmitterTree*>(tree)->sample(at, u);
  return drawn ? LaneDraw{drawn->triangle, drawn->pdf_area} : LaneDraw{kNoHit, 0.0};
}

void append(std::vector<float>& table, const Rgb& colour) {
  table.insert(table.end(), {colour.x, colour.y, colour.z});
}

}  // namespace

MatteGroup::MatteGroup(const Transport& transport) : mesh_(transport.mesh), max_depth_(transport.settings.max_depth) {
  if (mesh_.triangles.empty() || !covers(transport)) return;
  kernel_ = kernel_with(transport.settings.traversal, matte_kernel_avx512, matte_kernel_avx2);
  if (kernel_ == nullptr) return;
  if (transport.normals && !mesh_.corner_normals.empty()) corner_normals_ = mesh_.corner_normals.data();
  read_materials(transport.scene.materials);
  read_lights(transport);
  batch_ = std::clamp(kBatchShadows / (lights_.size() + 1), std::size_t{8}, kBatch);
  chosen_.reserve(batch_);

  read_scene(query_, transport);
  query_.diffuse = diffuse_.data();
  query_.emission = emission_.data();
  query_.sobol = transport.settings.sampler == Sampler::kSobol;
  query_.sobol_third = sobol::kThird.of_digits.front().data();
  static_assert(kLaneMostCasters == kMostCasters);
  for (const CausticCaster& c : transport.casters) casters_.insert(casters_.end(), {c.centre.x, c.centre.y, c.centre.z, c.radius});
  query_.casters = {casters_.data(), transport.casters.size(), kCasterBoost, kMostToCasters, kLeastCone, kLastCasterBounce};
}

void MatteGroup::read_materials(const std::vector<Material>& materials) {
  for (const Material& material : materials) {
    plain_.push_back(plain(material) ? 1 : 0);
    append(diffuse_, material.diffuse);
    append(emission_, material.emission);
  }
}

void MatteGroup::read_lights(const Transport& transport) {
  for (const PointLight& light : transport.point_lights) {
    const auto range = static_cast<double>(light.range);
    lights_.push_back({.position = {static_cast<double>(light.position.x), static_cast<double>(light.position.y),
                                    static_cast<double>(light.position.z)},
                       .intensity = {static_cast<double>(light.intensity.x), static_cast<double>(light.intensity.y),
                                     static_cast<double>(light.intensity.z)},
                       .range2 = light.range < kEndlessRange ? range * range : 0.0});
  }
  query_.point_lights = lights_.data();
  query_.point_light_count = lights_.size();
  const Emitters& emitters = transport.emitters;
  if (!transport.settings.emitter_sampling) return;
  query_.emitters = emitters.triangles().data();
  query_.cumulative = emitters.cumulative().data();
  query_.emitter_count = emitters.triangles().size();
  for (std::uint32_t m = 0; m < transport.scene.materials.size(); ++m) pdf_area_.push_back(emitters.pdf_area(m));
  query_.pdf_area = pdf_area_.data();
  if (!transport.emitters_by_tree) return;
  query_.tree = &emitters.tree(transport.scene);
  query_.draw = draw_from_tree;
}

void MatteGroup::shade(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
  if (chosen_.empty()) return;
  MatteQuery query = query_;
  open_batch(query, chosen_, transport, range, sinks);
  const ShadowQueue::Room room = sinks.shadows.open(chosen_.size() * (lights_.size() + 1));
  query.shadow_rays = reinterpret_cast<LaneRay*>(room.rays);
  query.shadow_lights = reinterpret_cast<LaneLight*>(room.waiting);
  query.shadow_from = room.from;
  query.shadow_to = room.to;
  MatteCounts counts{};
  kernel_(query, counts);
  sinks.stats.lane_mattes += chosen_.size();
  close_batch(counts, chosen_, transport, sinks);
  sinks.shadows.close(room, counts.shadows);
  sinks.stats.lights_at_hits += counts.lights_at_hits;
  if (!sinks.shadows.full()) return;
  sinks.shadows.flush(transport.tree, transport.settings.traversal, sinks.results, sinks.stats);
  sinks.stopped = sinks.stop.stop_requested();
}

}  // namespace raykiln::render
