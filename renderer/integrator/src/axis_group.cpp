#include "axis_group.hpp"

#include "lane_choice.hpp"
#include "raykiln/sampling/warp.hpp"
#include "vertex_batch.hpp"

namespace raykiln::render {
namespace {

/// Beyond, tables that are made once a task would cost more than they save.
constexpr std::size_t kMostMaterials = 4096;
constexpr std::size_t kMostLights = 255;

/// Is everything that these settings ask for at such a vertex in the kernel?
bool covers(const Transport& t) {
  const PathSettings& s = t.settings;
  return s.branches == 1 && s.max_depth > 0 && (s.left_out - EffectSet{Effect::kWatertightTriangles}).empty() &&
         s.bsdf.direction_sampling == DirectionSampling::kBsdf && s.bsdf.light.fresnel == FresnelFormula::kExact &&
         t.environment == nullptr && t.textures == nullptr && !t.gaps.any() && t.spot_lights.empty() &&
         t.directional_lights.empty() && t.point_lights.size() <= kMostLights &&
         t.scene.materials.size() <= kMostMaterials;
}

bool of_axes(const Material& m) {
  const Rgb black(0.0F);
  return m.model == SurfaceModel::kPhong && m.diffuse == black && m.specular != black &&
         m.specular_exp >= kLargestExponent && m.emission == black && m.facets.absorption == black;
}

double number_at(const LanePath& path, std::uint32_t dimension) {
  const auto& state = reinterpret_cast<const PathState&>(path);
  return uniform(vertex_key(state.key, state.node, state.bounce), static_cast<Dimension>(dimension));
}

void put(double (&into)[3], const Vec3d& v) {
  for (int k = 0; k < 3; ++k) into[k] = v[k];
}

}  // namespace

AxisGroup::AxisGroup(const Transport& transport)
    : mesh_(transport.mesh), max_depth_(transport.settings.max_depth) {
  if (mesh_.triangles.empty() || !covers(transport)) return;
  kernel_ = kernel_with(transport.settings.traversal, axis_kernel_avx512, axis_kernel_avx2);
  if (kernel_ == nullptr) return;
  read_materials(transport.scene.materials);
  read_lights(transport);
  chosen_.reserve(kBatch);
  left_.resize(kBatch);

  read_scene(query_, transport);
  if (transport.normals && !mesh_.corner_normals.empty() && !mesh_.normals.empty()) {
    query_.normals = &mesh_.normals.data()->x;
    query_.corner_normals = mesh_.corner_normals.data()->data();
  }
  query_.materials = materials_.data();
  query_.radiance_scaling = transport.settings.bsdf.light.radiance_scaling;
  query_.peak = cosine_power_pdf(0.0, kLargestExponent);
  query_.number = number_at;
  query_.side_dimension = static_cast<std::uint32_t>(Dimension::kFresnelChoice);
  query_.roulette_dimension = static_cast<std::uint32_t>(Dimension::kRoulette);
}

void AxisGroup::read_materials(const std::vector<Material>& materials) {
  for (const Material& material : materials) {
    of_axes_.push_back(of_axes(material) ? 1 : 0);
    const auto transparent = static_cast<double>(material.transparent);
    LaneAxisMaterial& read = materials_.emplace_back();
    put(read.opaque, Rgbd(material.specular) * (1.0 - transparent));
    put(read.clear, Rgbd(material.specular) * transparent);
    read.transparent = transparent;
    read.index = static_cast<double>(material.index_of_refraction);
  }
}

void AxisGroup::read_lights(const Transport& transport) {
  for (const PointLight& light : transport.point_lights) {
    for (int k = 0; k < 3; ++k) lights_.push_back(static_cast<double>(light.position[k]));
  }
  query_.point_lights = lights_.data();
  query_.point_light_count = transport.point_lights.size();
  put(query_.emitters_lo, Vec3d(transport.emitters.box().lo));
  put(query_.emitters_hi, Vec3d(transport.emitters.box().hi));
  query_.axis_width = kAxisWidth;
}

std::span<const std::uint32_t> AxisGroup::shade(const Transport& transport, const ShadingRange& range,
                                                ShadingSinks& sinks) {
  if (chosen_.empty()) return {};
  AxisQuery query = query_;
  open_batch(query, chosen_, transport, range, sinks);
  query.left = left_.data();
  AxisCounts counts{};
  kernel_(query, counts);
  sinks.stats.lane_axes += chosen_.size() - counts.left;
  close_batch(counts, chosen_, transport, sinks);
  return {left_.data(), counts.left};
}

}  // namespace raykiln::render
