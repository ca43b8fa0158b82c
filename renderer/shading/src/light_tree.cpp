#include "raykiln/shading/light_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "light_tree_build.hpp"

namespace raykiln::render {
namespace {

using Node = LightTree::Node;

/// Edge-on an emitter still counts for this share of its power: bounds are rounded to float, and what
/// a rounding excludes must not be left with a density of 0.
constexpr double kLeastCosine = 0x1p-10;

/// A receiver in double.
struct Place {
  Vec3d p, normal, steepness;  ///< steepness: |normal|, by component
  bool both_sides;
};

Place place_of(const EmitterReceiver& r) {
  const Vec3d normal(r.normal);
  return {Vec3d(r.p), normal, abs(normal), r.both_sides};
}

double sine_of(double cosine) { return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)); }

/// Bound on the light that a node may send here, up to a factor: power over the squared distance of the
/// box's middle, times the largest cosines that the cone of normals and the sphere about the box
/// allow at both ends. 0 only where the whole box is behind the surface.
double importance(const Node& node, const Place& at) {
  const Vec3d lo(node.lo), hi(node.hi);
  const Vec3d way = 0.5 * (lo + hi) - at.p;
  const double height = dot(at.normal, way);
  if (!at.both_sides && !(height + dot(at.steepness, 0.5 * (hi - lo)) > 0.0)) return 0.0;
  const double d2 = dot(way, way);
  const auto radius = static_cast<double>(node.radius);
  if (!(d2 > radius * radius)) return node.power / (radius * radius);
  const double over_d = 1.0 / std::sqrt(d2);
  const double sin_box = radius * over_d, cos_box = sine_of(sin_box);

  // Angles a - b, 0 where b is larger, by their cosines and sines.
  double emission = 1.0;
  const double cos_e = std::min(1.0, std::abs(dot(Vec3d(node.axis), way)) * over_d);
  if (const auto cos_spread = static_cast<double>(node.cos_spread); cos_e < cos_spread) {
    const double sin_e = sine_of(cos_e), sin_spread = static_cast<double>(node.sin_spread);
    const double cosine = cos_e * cos_spread + sin_e * sin_spread;
    const double sine = sin_e * cos_spread - cos_e * sin_spread;
    if (cosine < cos_box) emission = cosine * cos_box + sine * sin_box;
  }
  double arrival = 1.0;
  double cos_i = std::min(1.0, height * over_d);
  if (at.both_sides) cos_i = std::abs(cos_i);
  if (cos_i < cos_box) arrival = cos_i * cos_box + sine_of(cos_i) * sin_box;
  // The sphere reaches above the plane wherever the box does; roundings apart.
  return node.power * std::max(emission, kLeastCosine) * std::max(arrival, kLeastCosine) * (over_d * over_d);
}

/// The first child's share; negative where neither can light the place.
double first_share(const Node* children, const Place& at) {
  const double a = importance(children[0], at), b = importance(children[1], at);
  const double both = a + b;
  return both > 0.0 ? a / both : -1.0;
}

int length_of(std::uint64_t way) { return static_cast<int>(std::bit_width(way)) - 1; }

}  // namespace

LightTree::LightTree(std::span<const EmitterBounds> emitters) {
  if (emitters.empty()) return;
  light_tree::Built built = light_tree::build(emitters);
  nodes_ = std::move(built.nodes);
  ways_ = std::move(built.ways);
}

std::optional<LightTreeDraw> LightTree::sample(const EmitterReceiver& receiver, double u) const {
  if (nodes_.empty()) return std::nullopt;
  const Place at = place_of(receiver);
  constexpr double kBelowOne = 1.0 - 0x1p-53;
  double probability = 1.0;
  const Node* node = nodes_.data();
  while ((node->link & kLeaf) == 0) {
    const Node* children = nodes_.data() + node->link;
    const double share = first_share(children, at);
    if (share < 0.0) return std::nullopt;
    const bool first = u < share;
    const double taken = first ? share : 1.0 - share;
    u = std::min((first ? u : u - share) / taken, kBelowOne);
    probability *= taken;
    node = first ? children : children + 1;
  }
  return LightTreeDraw{node->link & ~kLeaf, probability};
}

double LightTree::probability(const EmitterReceiver& receiver, std::uint32_t emitter) const {
  const Place at = place_of(receiver);
  double probability = 1.0;
  const Node* node = nodes_.data();
  for (std::uint64_t way = ways_[emitter]; way > 1 && probability > 0.0; way >>= 1) {
    const Node* children = nodes_.data() + node->link;
    const double share = first_share(children, at);
    if (share < 0.0) return 0.0;
    const bool second = (way & 1U) != 0;
    probability *= second ? 1.0 - share : share;
    node = children + (second ? 1 : 0);
  }
  return probability;
}

int LightTree::depth() const {
  int deepest = 0;
  for (const std::uint64_t way : ways_) deepest = std::max(deepest, length_of(way));
  return deepest;
}

}  // namespace raykiln::render
