#include "raykiln/shading/light_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "light_tree_build.hpp"

namespace raykiln::render {
namespace {

using Node = LightTree::Node;

/// Edge-on an emitter still counts for this share of its power, and so does what a surface just sees: means over
/// a node say little of what is in it, and weights of up to 1 over this are borne, but not any.
constexpr double kLeastCosine = 0x1p-6;

/// A receiver in double.
struct Place {
  Vec3d p, normal, steepness;  ///< steepness: |normal|, by component
  bool both_sides;
};

Place place_of(const EmitterReceiver& r) {
  const Vec3d normal(r.normal);
  return {Vec3d(r.p), normal, abs(normal), r.both_sides};
}

/// Means of |x| and of max(x, 0) over numbers within `spread` of `middle`, all alike. spread > 0.
double mean_magnitude(double middle, double spread) {
  const double size = std::abs(middle);
  return size >= spread ? size : 0.5 * (size * size + spread * spread) / spread;
}
double mean_positive(double middle, double spread) {
  if (middle >= spread) return middle;
  const double reach = std::max(middle + spread, 0.0);
  return 0.25 * reach * reach / spread;
}

bool wholly_behind(const Node& node, const Place& at) {
  const Vec3d lo(node.lo), hi(node.hi);
  const double height = dot(at.normal, 0.5 * (lo + hi) - at.p);
  return !(height + dot(at.steepness, 0.5 * (hi - lo)) > 0.0);
}

/// Is all of the node's light sent the other way? Told of parallel normals alone: cones need their whole
/// box in view, and the mean of the cosine is small there already.
bool wholly_turned_away(const Node& node, const Place& at) {
  if (!(node.one_sided() && node.sin_spread == 0.0F)) return false;
  const Vec3d lo(node.lo), hi(node.hi), axis(node.axis);
  return !(dot(axis, at.p - 0.5 * (lo + hi)) + dot(abs(axis), 0.5 * (hi - lo)) > 0.0);
}

/// The light that a node may send here, up to a factor: power over the squared distance of its middle (by power, not of its
/// box), which is not taken to be below the node's reach, times the means of both cosines over
/// what is within that reach and about the cone of normals. 0 only where the whole box is behind the surface, or shines away from it.
/// Means instead of bounds: a bound makes alike what is near and what is not, wherever
/// nodes are wide (tests/bench has the figures).
double importance(const Node& node, const Place& at) {
  if ((!at.both_sides && wholly_behind(node, at)) || wholly_turned_away(node, at)) return 0.0;
  const Vec3d way = Vec3d(node.middle) - at.p;
  const auto reach = static_cast<double>(node.reach);
  const double d2 = std::max({dot(way, way), reach * reach, std::numeric_limits<double>::min()});
  const double over_d = 1.0 / std::sqrt(d2), across = std::max(reach * over_d, kLeastCosine);
  const double turned = std::min(across + std::abs(static_cast<double>(node.sin_spread)), 1.0);
  const double towards = -dot(Vec3d(node.axis), way) * over_d;
  const double emission = node.one_sided() ? mean_positive(towards, turned) : mean_magnitude(towards, turned);
  const double height = dot(at.normal, way) * over_d;
  const double arrival = at.both_sides ? mean_magnitude(height, across) : mean_positive(height, across);
  return static_cast<double>(node.power) * std::max(emission, kLeastCosine) * std::max(arrival, kLeastCosine) *
         (over_d * over_d);
}

/// The first child's share; negative where neither can light the place.
double first_share(const Node* children, const Place& at) {
  const double a = importance(children[0], at), b = importance(children[1], at);
  const double both = a + b;
  return both > 0.0 ? a / both : -1.0;
}

int length_of(std::uint64_t way) { return static_cast<int>(std::bit_width(way)) - 1; }

}  // namespace

LightTree::LightTree(std::span<const EmitterBounds> emitters, const std::stop_token& stop) {
  if (emitters.empty()) return;
  light_tree::Built built = light_tree::build(emitters, stop);
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
