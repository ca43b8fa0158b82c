#include "raykiln/shading/emitter_tree.hpp"

#include <bit>

#include "triangle_span.hpp"

namespace raykiln::render {
namespace {

constexpr std::uint32_t kBits = 64;

std::size_t words_for(std::size_t triangles) { return (triangles + kBits - 1) / kBits; }

EmitterBounds bounds_of(const TriangleMesh& mesh, std::uint32_t id, double power, bool one_sided) {
  Bounds3f box;
  for (const std::uint32_t corner : mesh.triangles[id]) box.grow(mesh.positions[corner]);
  return {.lo = box.lo,
          .hi = box.hi,
          .axis = Vec3f(normalize(triangle_span(mesh, id))),
          .power = power,
          .one_sided = one_sided};
}

}  // namespace

EmitterTree::EmitterTree(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                         std::span<const double> weights, std::span<const Material> materials,
                         const std::stop_token& stop)
    : shines_(words_for(mesh.triangles.size())), before_(shines_.size()) {
  std::vector<EmitterBounds> leaves;
  leaves.reserve(triangles.size());
  emitters_.reserve(triangles.size());
  for (const std::uint32_t id : triangles) {
    const double area = triangle_area(mesh, id);
    const std::uint32_t material = mesh.material_ids[id];
    leaves.push_back(bounds_of(mesh, id, weights[material] * area, materials[material].one_sided));
    emitters_.push_back({area, id});
    shines_[id / kBits] |= std::uint64_t{1} << id % kBits;
  }
  tree_ = LightTree(leaves, stop);
  std::uint32_t seen = 0;
  for (std::size_t w = 0; w < shines_.size(); ++w) {
    before_[w] = seen;
    seen += static_cast<std::uint32_t>(std::popcount(shines_[w]));
  }
}

std::optional<EmitterTree::Draw> EmitterTree::sample(const EmitterReceiver& receiver, double u) const {
  const auto drawn = tree_.sample(receiver, u);
  if (!drawn) return std::nullopt;
  const Emitter& emitter = emitters_[drawn->emitter];
  return Draw{emitter.triangle, drawn->probability / emitter.area};
}

double EmitterTree::pdf_area(const EmitterReceiver& receiver, std::uint32_t triangle) const {
  const std::uint64_t word = shines_[triangle / kBits], bit = std::uint64_t{1} << triangle % kBits;
  if ((word & bit) == 0) return 0.0;
  const std::uint32_t emitter =
      before_[triangle / kBits] + static_cast<std::uint32_t>(std::popcount(word & (bit - 1)));
  return tree_.probability(receiver, emitter) / emitters_[emitter].area;
}

std::size_t EmitterTree::bytes(std::size_t emitters, std::size_t triangles) {
  return LightTree::bytes(emitters) + emitters * sizeof(Emitter) +
         words_for(triangles) * (sizeof(std::uint64_t) + sizeof(std::uint32_t));
}

}  // namespace raykiln::render
