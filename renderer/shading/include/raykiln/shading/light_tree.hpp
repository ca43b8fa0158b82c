// A tree over emitters, for drawing one by what it may bring to a given surface.
//
// Conty Estevez & Kulla 2018, "Importance sampling of many lights with adaptive tree splitting", without the
// splitting: a node knows a box, a cone about its emitters' normals, their power, and where by power their middle is and how far
// they reach about it; a draw goes down from the root by an estimate of power cos cos / distance^2, once per level.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "raykiln/math/ray.hpp"
#include "raykiln/math/vec.hpp"

namespace raykiln::render {

/// A flat emitter that shines to both of its sides alike, or to its front alone.
struct EmitterBounds {
  Vec3f lo{0.0F}, hi{0.0F};
  Vec3f axis{0.0F, 0.0F, 1.0F};  ///< unit normal; to the front, or either way
  double power = 0.0;            ///< > 0, up to a factor that all share
  bool one_sided = false;        ///< shines only to where the axis points
};

/// What light is to arrive at.
struct EmitterReceiver {
  Vec3f p{0.0F};
  Vec3f normal{0.0F};      ///< unit, on the side that counts
  bool both_sides = true;  ///< light from behind counts as well
};

struct LightTreeDraw {
  std::uint32_t emitter = 0;  ///< index into the span that the tree was made of
  double probability = 0.0;   ///< of it, for this receiver
};

/// Immutable. Made of equal spans trees are equal, bit for bit; scaling all lengths, or all powers,
/// by a power of two changes no draw.
class LightTree {
 public:
  LightTree() = default;
  /// O(n log n). Empty where stop was requested before it was whole. Precondition: fewer than 2^31 emitters.
  explicit LightTree(std::span<const EmitterBounds> emitters, const std::stop_token& stop = {});

  /// Draws by u in [0, 1), which is used up. Nothing where no emitter can light the receiver.
  [[nodiscard]] std::optional<LightTreeDraw> sample(const EmitterReceiver& receiver, double u) const;

  /// That sample() draws this emitter for the receiver: the same number, bit for bit.
  [[nodiscard]] double probability(const EmitterReceiver& receiver, std::uint32_t emitter) const;

  [[nodiscard]] std::size_t size() const { return ways_.size(); }
  [[nodiscard]] int depth() const;  ///< of the deepest emitter; 0 for one alone

  /// One cache line. Siblings stand side by side.
  struct alignas(64) Node {
    Vec3f lo{0.0F}, hi{0.0F};
    Vec3f middle{0.0F};        ///< mean place by power
    Vec3f axis{0.0F};          ///< of the cone of normals; either way unless one_sided()
    float sin_spread = 0.0F;   ///< of its half angle, 0 to pi/2; its sign says one_sided()
    float reach = 0.0F;        ///< twice the standard deviation from the middle, by an axis
    float power = 0.0F;        ///< over a power of two, so that it fits
    std::uint32_t link = 0;    ///< of the first of two children, or of an emitter with kLeaf

    /// All that is in it shines only to where the axis points, within the cone.
    [[nodiscard]] bool one_sided() const { return std::signbit(sin_spread); }
  };
  static constexpr std::uint32_t kLeaf = 0x80000000U;

  /// Of a tree over so many emitters.
  [[nodiscard]] static constexpr std::size_t bytes(std::size_t emitters) {
    return emitters == 0 ? 0 : (2 * emitters - 1) * sizeof(Node) + emitters * sizeof(std::uint64_t);
  }

 private:
  std::vector<Node> nodes_;           ///< the root first
  std::vector<std::uint64_t> ways_;   ///< to each emitter: turns from the lowest bit on, a 1 above them
};

}  // namespace raykiln::render
