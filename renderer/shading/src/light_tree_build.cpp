#include "light_tree_build.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace raykiln::render::light_tree {
namespace {

using Node = LightTree::Node;

constexpr int kBins = 16;
/// From here on halves: with at most 31 halvings a way fits into 63 bits.
constexpr int kDeepestSplitByCost = 30;
/// What normals in all directions cost beyond parallel ones, in the measure of Conty Estevez & Kulla 2018:
/// (2 pi + pi^2 / 2) / pi - 1 for a cone of half angle pi/2, whose normals are 1/2 on average.
constexpr double kCostOfSpread = 2.0 * 2.57;

Vec3d middle_of(const EmitterBounds& e) { return 0.5 * (Vec3d(e.lo) + Vec3d(e.hi)); }

/// What a set of emitters is for the cost.
struct Cluster {
  Bounds3f box;
  Vec3d normals{0.0};  ///< times power; those that mean either way on one side of a reference
  double power = 0.0;
  std::size_t count = 0;

  void add(const EmitterBounds& e, const Vec3d& reference) {
    box.grow(e.lo);
    box.grow(e.hi);
    const Vec3d axis(e.axis);
    normals += (!e.one_sided && dot(axis, reference) < 0.0 ? -e.power : e.power) * axis;
    power += e.power;
    ++count;
  }
  void add(const Cluster& other) {
    if (other.count == 0) return;
    box.grow(other.box.lo);
    box.grow(other.box.hi);
    normals += other.normals;
    power += other.power;
    count += other.count;
  }
  /// Power times squared diagonal times a measure of how far normals spread.
  [[nodiscard]] double cost() const {
    if (count == 0) return 0.0;
    const Vec3d side = Vec3d(box.hi) - Vec3d(box.lo);
    const double spread = 1.0 - std::min(1.0, length(normals) / power);
    return power * dot(side, side) * (1.0 + kCostOfSpread * spread);
  }
};

/// A cone about an axis, which has a direction where all that is in it shines to one side alone.
struct Cone {
  Vec3d axis{0.0};
  double spread = 0.0;  ///< half angle, 0 to pi/2
  bool one_sided = false;
};

constexpr std::size_t kAskFrom = 1024;  ///< emitters of a node at which it is asked whether to stop

constexpr double kHalfPi = 1.57079632679489661923;

/// The narrowest cone that holds both, or one a little wider. Of more than a half space it has no direction.
Cone united(const Cone& a, const Cone& b) {
  if (a.spread < b.spread) return united(b, a);
  const bool one_sided = a.one_sided && b.one_sided;
  const Vec3d towards = !one_sided && dot(a.axis, b.axis) < 0.0 ? -b.axis : b.axis;
  const Vec3d turn = cross(a.axis, towards);
  const double between = std::atan2(length(turn), dot(a.axis, towards));
  if (between + b.spread <= a.spread) return {a.axis, a.spread, one_sided};
  const double spread = 0.5 * (a.spread + between + b.spread);
  if (!(spread < kHalfPi)) {
    return one_sided ? united({a.axis, a.spread}, {b.axis, b.spread}) : Cone{a.axis, kHalfPi};
  }
  const double angle = spread - a.spread;
  const Vec3d aside = towards - dot(towards, a.axis) * a.axis;
  const double sine = length(aside);
  if (!(sine > 0.0)) return {a.axis, spread, one_sided};
  return {normalize(std::cos(angle) * a.axis + std::sin(angle) / sine * aside), spread, one_sided};
}

/// Where power is: its sum, its mean place, and its mean squared distance from that.
struct Moments {
  double power = 0.0;
  Vec3d middle{0.0};
  double variance = 0.0;

  /// Of an emitter: a triangle whose box this is, at its middle. Right triangles across the box vary by 1/18 of its
  /// squared diagonal, others by less.
  explicit Moments(const EmitterBounds& e) : power(e.power), middle(middle_of(e)) {
    const Vec3d side = Vec3d(e.hi) - Vec3d(e.lo);
    variance = dot(side, side) / 18.0;
  }
  Moments(const Moments& a, const Moments& b) : power(a.power + b.power) {
    const double share = b.power / power;
    const Vec3d apart = b.middle - a.middle;
    middle = a.middle + share * apart;
    variance = (1.0 - share) * a.variance + share * b.variance + share * (1.0 - share) * dot(apart, apart);
  }
};

struct Grown {
  Cone cone;
  Moments moments;
};

/// 1 over the power of two at or below the sum of all powers.
double power_scale(std::span<const EmitterBounds> emitters) {
  double sum = 0.0;
  for (const EmitterBounds& e : emitters) sum += e.power;
  int exponent = 0;
  (void)std::frexp(sum, &exponent);
  return std::ldexp(1.0, -exponent);
}

class Builder {
 public:
  Builder(std::span<const EmitterBounds> emitters, const std::stop_token& stop)
      : emitters_(emitters), stop_(stop), order_(emitters.size()), power_scale_(power_scale(emitters)) {
    std::iota(order_.begin(), order_.end(), 0U);
    built_.ways.resize(emitters.size());
    built_.nodes.reserve(2 * emitters.size() - 1);
    built_.nodes.emplace_back();
    grow(0, 0, order_.size(), {.turns = 0, .depth = 0});
  }
  Built take() { return stopped_ ? Built{} : std::move(built_); }

 private:
  struct Way {
    std::uint64_t turns;
    int depth;
    [[nodiscard]] Way turn(std::uint64_t side) const { return {turns | side << depth, depth + 1}; }
  };

  /// Makes node `at` of order_[begin, end).
  Grown grow(std::size_t at, std::size_t begin, std::size_t end, const Way& way) {
    if (end - begin == 1) return leaf(at, order_[begin], way);
    if (end - begin >= kAskFrom && stop_.stop_requested()) {
      stopped_ = true;  // nobody will look at the nodes
      return {{}, Moments(emitters_[order_[begin]])};
    }
    const std::size_t split =
        way.depth < kDeepestSplitByCost ? by_cost(begin, end) : begin + (end - begin) / 2;
    const std::size_t children = built_.nodes.size();
    built_.nodes.resize(children + 2);
    const Grown a = grow(children, begin, split, way.turn(0));
    const Grown b = grow(children + 1, split, end, way.turn(1));
    Node& node = built_.nodes[at];
    const Node& first = built_.nodes[children];
    const Node& second = built_.nodes[children + 1];
    node.lo = min(first.lo, second.lo);
    node.hi = max(first.hi, second.hi);
    node.link = static_cast<std::uint32_t>(children);
    return finish(node, {united(a.cone, b.cone), Moments(a.moments, b.moments)});
  }

  Grown leaf(std::size_t at, std::uint32_t emitter, const Way& way) {
    const EmitterBounds& e = emitters_[emitter];
    built_.ways[emitter] = way.turns | std::uint64_t{1} << way.depth;
    Node& node = built_.nodes[at];
    node.lo = e.lo;
    node.hi = e.hi;
    node.link = emitter | LightTree::kLeaf;
    return finish(node, {{Vec3d(e.axis), 0.0, e.one_sided}, Moments(e)});
  }

  Grown finish(Node& node, const Grown& grown) const {
    node.axis = Vec3f(grown.cone.axis);
    const auto sine = static_cast<float>(std::sin(grown.cone.spread));
    node.sin_spread = grown.cone.one_sided ? -sine : sine;
    node.middle = Vec3f(grown.moments.middle);
    node.reach = static_cast<float>(2.0 * std::sqrt(grown.moments.variance / 3.0));
    // What is 1e38 times dimmer than all together is still drawn.
    const double power = grown.moments.power * power_scale_;
    node.power = std::max(static_cast<float>(power), std::numeric_limits<float>::min());
    return grown;
  }

  struct Split {
    int axis = -1, bin = 0;  ///< bins up to this one go first
    double cost = 0.0;
  };

  /// Parts order_[begin, end) where the two sides cost least; in halves where all middles coincide.
  std::size_t by_cost(std::size_t begin, std::size_t end) {
    Vec3d lo = middle_of(emitters_[order_[begin]]), hi = lo;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3d m = middle_of(emitters_[order_[i]]);
      lo = min(lo, m);
      hi = max(hi, m);
    }
    const Vec3d reference(emitters_[order_[begin]].axis);
    const double widest = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const double width = hi[axis] - lo[axis];
      if (!(width > 0.0)) continue;
      consider(axis, lo[axis], width, widest / width, {begin, end}, reference, best);
    }
    if (best.axis < 0) return begin + (end - begin) / 2;
    const double from = lo[best.axis], width = hi[best.axis] - from;
    const auto border = std::partition(at(begin), at(end), [&](std::uint32_t e) {
      return bin_of(middle_of(emitters_[e])[best.axis], from, width) <= best.bin;
    });
    return static_cast<std::size_t>(border - order_.begin());
  }

  /// All borders between bins along an axis; `stretch` punishes cuts across short sides.
  void consider(int axis, double from, double width, double stretch,
                const std::pair<std::size_t, std::size_t>& range, const Vec3d& reference,
                Split& best) const {
    std::array<Cluster, kBins> bins{};
    for (std::size_t i = range.first; i < range.second; ++i) {
      const EmitterBounds& e = emitters_[order_[i]];
      bins[static_cast<std::size_t>(bin_of(middle_of(e)[axis], from, width))].add(e, reference);
    }
    std::array<double, kBins> above{};
    Cluster sum;
    for (std::size_t b = kBins - 1; b > 0; --b) {
      sum.add(bins[b]);
      above[b] = sum.cost();
    }
    sum = {};
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
      sum.add(bins[b]);
      // The first and the last bin hold something, so neither side is ever empty.
      const double cost = stretch * (sum.cost() + above[b + 1]);
      if (best.axis < 0 || cost < best.cost) best = {axis, static_cast<int>(b), cost};
    }
  }

  static int bin_of(double middle, double from, double width) {
    return std::min(static_cast<int>((middle - from) / width * kBins), kBins - 1);
  }
  [[nodiscard]] std::vector<std::uint32_t>::iterator at(std::size_t i) {
    return order_.begin() + static_cast<std::ptrdiff_t>(i);
  }

  std::span<const EmitterBounds> emitters_;
  const std::stop_token& stop_;
  bool stopped_ = false;
  std::vector<std::uint32_t> order_;
  double power_scale_;
  Built built_;
};

}  // namespace

Built build(std::span<const EmitterBounds> emitters, const std::stop_token& stop) { return Builder(emitters, stop).take(); }

}  // namespace raykiln::render::light_tree
