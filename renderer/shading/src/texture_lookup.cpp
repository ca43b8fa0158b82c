#include "raykiln/shading/texture_lookup.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "raykiln/math/srgb.hpp"
#include "raykiln/shading/texture_pyramid.hpp"

namespace raykiln::render {
namespace {

std::array<float, 256> decoded_bytes() {
  std::array<float, 256> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(linear_of_srgb(static_cast<double>(i) / 255.0));
  }
  return values;
}

Rgbd texel(const TextureImage& image, bool data, int x, int y) {
  static const std::array<float, 256> kDecoded = decoded_bytes();
  const std::size_t place = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                            static_cast<std::size_t>(x);
  if (image.channels == 1) {
    return Rgbd(image.srgb8.empty() ? static_cast<double>(image.linear[place])
                                    : static_cast<double>(image.srgb8[place]) / 255.0);
  }
  const std::size_t i = 3 * place;
  if (image.srgb8.empty()) return Rgbd(image.linear[i], image.linear[i + 1], image.linear[i + 2]);
  if (data) return Rgbd(image.srgb8[i], image.srgb8[i + 1], image.srgb8[i + 2]) / 255.0;
  return Rgbd(kDecoded[image.srgb8[i]], kDecoded[image.srgb8[i + 1]], kDecoded[image.srgb8[i + 2]]);
}

/// The coordinate brought near [0, 1], so that it stays exact in an int however far out it was.
double near_unit(double u, TextureWrap wrap) {
  if (!std::isfinite(u)) return 0.0;
  switch (wrap) {
    case TextureWrap::kRepeat: return u - std::floor(u);
    case TextureWrap::kMirror: return u - 2.0 * std::floor(0.5 * u);
    case TextureWrap::kClamp: break;
  }
  return std::clamp(u, 0.0, 1.0);
}

/// Index of a texel that may lie outside by less than two pictures.
int wrapped(int i, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::kClamp) return std::clamp(i, 0, size - 1);
  if (wrap == TextureWrap::kRepeat) return (i % size + size) % size;
  const int period = (i % (2 * size) + 2 * size) % (2 * size);
  return period < size ? period : 2 * size - 1 - period;
}

}  // namespace

Rgbd texture_value(const TextureImage& image, const TextureUse& use, double u, double v) {
  const double x = near_unit(u, use.wrap_u) * image.width;
  const double y = near_unit(v, use.wrap_v) * image.height;
  const auto at = [&](int i, int j) {
    return texel(image, use.data, wrapped(i, image.width, use.wrap_u), wrapped(j, image.height, use.wrap_v));
  };
  if (use.filter == TextureFilter::kNearest) {
    return at(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
  }
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const double s = x - 0.5 - left, t = y - 0.5 - top;
  const int i = static_cast<int>(left), j = static_cast<int>(top);
  return (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j)) +
         t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
}

namespace {

/// Log2 of how many texels the footprint is wide, less 1: bilinear reading of a copy has a tent two texels wide, which is
/// as wide as the footprint then.
double level_of(const TextureUse& use, const TextureImage& image, const std::array<Vec2f, 3>& corner, double footprint) {
  const Vec3d first(corner[1] - corner[0], 0.0F), second(corner[2] - corner[0], 0.0F);
  const double turn = dot(use.u_row, first) * dot(use.v_row, second) - dot(use.u_row, second) * dot(use.v_row, first);
  const double texels = std::abs(turn) * image.width * image.height;
  return 0.5 * std::log2(texels * footprint) - 1.0;
}

}  // namespace

Rgbd texture_value(const SurfaceTextures& textures, const TextureUse& use,
                   const TrianglePlace& at) {
  const UvSet& set = textures.uv_sets[use.uv_set];
  if (at.id >= set.corners.size()) return Rgbd(1.0);
  const auto& corner = set.corners[at.id];
  if (corner[0] == kNoUv || corner[1] == kNoUv || corner[2] == kNoUv) return Rgbd(1.0);
  const Vec2f& a = set.coordinates[corner[0]];
  const Vec2f& b = set.coordinates[corner[1]];
  const Vec2f& c = set.coordinates[corner[2]];
  const double first = 1.0 - at.u - at.v;
  const auto mix = [&](float p, float q, float r) {
    return first * static_cast<double>(p) + at.u * static_cast<double>(q) +
           at.v * static_cast<double>(r);
  };
  const Vec3d uv(mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), 1.0);
  const TextureImage& image = textures.images[use.image];
  const double x = dot(use.u_row, uv), y = dot(use.v_row, uv);
  if (at.pyramids == nullptr) return texture_value(image, use, x, y);
  return at.pyramids->value(use, x, y, level_of(use, image, {a, b, c}, at.footprint));
}

namespace {

MetallicRoughness metal_at(const SurfaceTextures& textures, const MaterialTextures& used,
                           const TrianglePlace& at) {
  MetallicRoughness here = used.metal;
  if (used.base.used()) here.base *= Rgb(texture_value(textures, used.base, at));
  if (used.roughness.used()) {
    const Rgbd value = texture_value(textures, used.roughness, at);
    here.roughness *= value.y;
    here.metallic *= static_cast<float>(value.z);
  }
  if (used.through.used()) {
    here.through *= static_cast<float>(texture_value(textures, used.through, at).x);
  }
  return here;
}

}  // namespace

// A white texel is exactly 1, and the material exactly what it is without the texture.
void paint(const SurfaceTextures& textures, const Material& material, std::uint32_t id,
           const TrianglePlace& at, Material& painted) {
  painted.diffuse = material.diffuse;
  painted.specular = material.specular;
  painted.transparent = material.transparent;
  painted.specular_exp = material.specular_exp;
  painted.index_of_refraction = material.index_of_refraction;
  painted.emission = material.emission;
  painted.model = material.model;
  painted.facets = material.facets;
  if (id >= textures.materials.size()) return;
  const MaterialTextures& used = textures.materials[id];
  const bool mixed = used.roughness.used() || used.through.used();
  if (mixed && material.model == SurfaceModel::kMicrofacet) {
    mix_metal(metal_at(textures, used, at), painted);
  } else if (used.base.used()) {
    const Rgb value(texture_value(textures, used.base, at));
    painted.diffuse *= value;
    painted.specular *= Rgb(1.0F) - used.specular_tint * (Rgb(1.0F) - value);
    painted.facets.tint *= value;
  }
  if (used.through_colour.used()) {
    painted.facets.diffuse_through *= Rgb(texture_value(textures, used.through_colour, at));
  }
  if (used.emission.used()) {
    painted.emission = Rgb(Rgbd(material.emission) * texture_value(textures, used.emission, {at.id, at.u, at.v}));
  }
}

Rgbd emission_factor(const SurfaceTextures& textures, std::uint32_t material,
                     const TrianglePlace& at) {
  if (material >= textures.materials.size()) return Rgbd(1.0);
  const TextureUse& use = textures.materials[material].emission;
  return use.used() ? texture_value(textures, use, at) : Rgbd(1.0);
}

// The frame of the picture on the triangle: x along growing u, y against growing v, which points down.
std::optional<Vec3f> mapped_normal(const SurfaceTextures& textures, const TriangleMesh& mesh,
                                   std::uint32_t material, const TrianglePlace& at, const Vec3f& ns) {
  if (material >= textures.materials.size()) return std::nullopt;
  const MaterialTextures& used = textures.materials[material];
  if (!used.normal.used()) return std::nullopt;
  const UvSet& set = textures.uv_sets[used.normal.uv_set];
  if (at.id >= set.corners.size()) return std::nullopt;
  const auto& corner = set.corners[at.id];
  if (corner[0] == kNoUv || corner[1] == kNoUv || corner[2] == kNoUv) return std::nullopt;
  const auto& vertex = mesh.triangles[at.id];
  const Vec3d p(mesh.positions[vertex[0]]);
  std::array<Vec3d, 2> edge;
  std::array<double, 2> du{}, dv{};
  for (std::size_t k = 0; k < 2; ++k) {
    edge[k] = Vec3d(mesh.positions[vertex[k + 1]]) - p;
    const Vec2f& from = set.coordinates[corner[0]];
    const Vec2f& to = set.coordinates[corner[k + 1]];
    const Vec3d step(static_cast<double>(to.x) - static_cast<double>(from.x),
                     static_cast<double>(to.y) - static_cast<double>(from.y), 0.0);
    du[k] = dot(used.normal.u_row, step);
    dv[k] = dot(used.normal.v_row, step);
  }
  const double area = du[0] * dv[1] - du[1] * dv[0];
  if (!(std::abs(area) > 0.0)) return std::nullopt;
  const double turned = area < 0.0 ? -1.0 : 1.0;
  const Vec3d n(ns), along = turned * (dv[1] * edge[0] - dv[0] * edge[1]);
  const Vec3d down = turned * (du[0] * edge[1] - du[1] * edge[0]);
  const Vec3d x = along - dot(along, n) * n;
  const double size = length(x);
  if (!(size > 0.0)) return std::nullopt;
  Vec3d y = cross(n, x / size);
  if (dot(y, down) > 0.0) y = -y;
  const Rgbd value = 2.0 * texture_value(textures, used.normal, at) - Rgbd(1.0);
  const Vec3d mapped = used.normal_scale * (value.x / size * x + value.y * y) + value.z * n;
  const double whole = length(mapped);
  if (!(whole > 0.0)) return std::nullopt;
  return Vec3f(mapped / whole);
}

double mean_largest_channel(const TextureImage& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height; ++y) {
    double row = 0.0;
    for (int x = 0; x < image.width; ++x) {
      const Rgbd value = texel(image, false, x, y);
      row += std::max({value.x, value.y, value.z});
    }
    sum += row;
  }
  return sum / (static_cast<double>(image.width) * image.height);
}

}  // namespace raykiln::render
