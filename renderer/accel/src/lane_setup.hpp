// Rays made ready for lanes, as many at a time as there are lanes: what `prepare` and the beginning
// of ScalarWalk do, with the same roundings. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_query.hpp"
#include "lane_rays.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

/// Rays that wait for a lane.
template <class V>
struct ReadyRays : LeafRays<V::kWidth> {
  static constexpr std::size_t kW = V::kWidth;
  float slack[kW], t0[kW], t1[kW];
  std::uint32_t backward[3];  ///< 1 for an axis along which the rays go down, if they go together
  std::uint32_t waiting;      ///< a bit for each that waits
  bool begun;                 ///< walked together with others first
  std::size_t index[kW];      ///< of the ray in each lane
};

/// kBatches: so many times V::kWidth rays are made ready at once. Leaf says whether it needs
/// slopes in double, and larger cells.
template <class V, class Leaf, std::uint32_t kBatches>
class RaySource {
 public:
  using F = typename V::F;
  using M = typename V::M;
  using Batch = ReadyRays<V>;
  static constexpr std::size_t kW = V::kWidth;

  explicit RaySource(const LaneQuery& query) : query_(query) {
    for (std::size_t k = 0; k < 8; ++k) {
      for (std::size_t i = 0; i < kW; ++i) raw_[k][i] = 0.0F;
    }
    for (Batch& batch : batches_) batch.waiting = 0;
  }

  /// The next ray that meets the root's box: its place in batch(), and its index. False at the end.
  /// Batches of rays that go together are first given to walk_together(batches, their bits), which
  /// leaves those waiting that are not done, and says whether that was worth it: if not, the next
  /// few rounds are not asked.
  template <typename Together>
  bool next(std::size_t& place, std::size_t& index, Together&& walk_together) {
    while (batches_[at_].waiting == 0) {
      if (++at_ < kBatches) continue;
      if (next_ray_ == query_.ray_count) {
        at_ = kBatches - 1;
        return false;
      }
      std::uint32_t together = 0;
      for (std::uint32_t i = 0; i < kBatches; ++i) {
        prepare_some(batches_[i]);
        batches_[i].begun = pause_ == 0 && go_together(batches_[i]);
        if (batches_[i].begun) together |= 1U << i;
      }
      if (pause_ != 0) --pause_;
      if (together != 0 && !walk_together(batches_, together)) pause_ = kPause;
      at_ = 0;
    }
    Batch& batch = batches_[at_];
    place = static_cast<std::size_t>(__builtin_ctz(batch.waiting));
    batch.waiting &= batch.waiting - 1;
    index = batch.index[place];
    return true;
  }

  /// Makes the rays of the first `n` indices of the batch ready; those that meet the root's box wait.
  [[gnu::noinline]] void prepare(Batch& batch, std::size_t n) {
    batch.waiting = 0;
    if (n == 0) return;
    const float* rays[kW];
    for (std::size_t i = 0; i < kW; ++i) rays[i] = query_.rays + 8 * batch.index[i < n ? i : 0];
    V::transpose(rays, raw_);
    const std::uint32_t given = (1U << n) - 1U;
    const std::uint32_t usable = invert(batch) & given;
    unusable_ += n - static_cast<std::size_t>(__builtin_popcount(usable));
    if (usable != 0) batch.waiting = enter_root(batch) & usable;
    if (batch.waiting == 0) return;
    shear(batch);
    if (query_.from != nullptr) keep_ends(batch.known, query_.from, batch, n);
    if constexpr (Leaf::kHasEnds) {
      V::store(batch.end, V::set1(kLaneNoHit));
      if (query_.to != nullptr) keep_ends(batch.end, query_.to, batch, n);
    }
  }

  /// Where the ray that next() gave is.
  [[nodiscard]] const Batch& batch() const { return batches_[at_]; }
  [[nodiscard]] std::uint32_t batch_number() const { return at_; }
  [[nodiscard]] std::uint64_t unusable() const { return unusable_; }

 private:
  void prepare_some(Batch& batch) {
    const std::size_t left = query_.ray_count - next_ray_;
    const std::size_t n = left < kW ? left : kW;
    for (std::size_t i = 0; i < n; ++i) batch.index[i] = next_ray_ + i;
    prepare(batch, n);
    next_ray_ += n;
    if constexpr (V::kFetchesMore) {
      // The rays that take this batch's place in the next round.
      constexpr std::size_t kOthers = kW * (kBatches - 1);
      if (left >= n + kOthers + kW) fetch_ahead<8 * kW>(query_.rays + 8 * (next_ray_ + kOthers));
    }
  }

  // Enough rays with the same signs of direction and the same main axis.
  static bool go_together(Batch& batch) {
    const std::uint32_t waiting = batch.waiting;
    if (static_cast<std::size_t>(__builtin_popcount(waiting)) * 2 < kW) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const M backward =
          V::lt(V::turn_sign(V::set1(1.0F), V::load(batch.inv_d[k])), V::set1(0.0F));
      const std::uint32_t lanes = V::bits(backward) & waiting;
      if (lanes != 0 && lanes != waiting) return false;
      batch.backward[k] = lanes != 0 ? 1U : 0U;
    }
    const std::uint32_t axis = batch.main_axis[__builtin_ctz(waiting)];
    return (V::bits(V::eq(V::load(batch.main_axis), V::set1(axis))) & waiting) == waiting;
  }

  // The inverse direction; a bit for every ray that can hit something.
  std::uint32_t invert(Batch& batch) const {
    const F d[3] = {V::load(raw_[4]), V::load(raw_[5]), V::load(raw_[6])};
    const F longest = V::larger_magnitude(V::larger_magnitude(d[0], d[1]), d[2]);
    M usable = V::both(V::le(V::abs(d[0]), V::set1(kMaxDirection)),
                       V::le(V::set1(kMinDirection), longest));
    for (std::size_t k = 1; k < 3; ++k) {
      usable = V::both(usable, V::le(V::abs(d[k]), V::set1(kMaxDirection)));
    }
    usable = V::both(usable, V::le(V::load(raw_[3]), V::load(raw_[7])));
    for (std::size_t k = 0; k < 3; ++k) {
      usable = V::both(usable, V::le(V::abs(V::load(raw_[k])), V::set1(kLargestFloat)));
      V::store(batch.inv_d[k], V::div(V::set1(1.0F), d[k]));
    }
    return V::bits(usable);
  }

  // The main axis and the slopes.
  void shear(Batch& batch) const {
    const F d[3] = {V::load(raw_[4]), V::load(raw_[5]), V::load(raw_[6])};
    const F ax = V::abs(d[0]);
    const F ay = V::abs(d[1]);
    const F az = V::abs(d[2]);
    const M is_x = V::both(V::le(ay, ax), V::le(az, ax));
    const M is_y = V::not_but(is_x, V::le(az, ay));
    auto axis = V::blend(is_y, V::set1(2U), V::set1(1U));
    axis = V::blend(is_x, axis, V::set1(0U));
    const F dz = V::select(axis, d[0], d[1], d[2]);
    const F dx = V::select(axis, d[1], d[2], d[0]);
    const F dy = V::select(axis, d[2], d[0], d[1]);
    V::store(batch.sx, V::div(dx, dz));
    V::store(batch.sy, V::div(dy, dz));
    keep_shear(batch, axis, dx, dy, dz);
  }

  // The slopes in double, as shear_ray has them.
  static void keep_shear(Batch& batch, typename V::I axis, F dx, F dy, F dz) {
    V::store(batch.main_axis, axis);
    if constexpr (Leaf::kInDouble) {
      V::store_quotients(batch.shear_x, dx, dz);
      V::store_quotients(batch.shear_y, dy, dz);
      V::store_quotients(batch.inv_dz, V::set1(1.0F), dz);
    }
  }

  // The interval within the root's box; a bit for every ray where it is not empty.
  std::uint32_t enter_root(Batch& batch) {
    F largest = V::set1(0.0F);
    for (std::size_t k = 0; k < 3; ++k) {
      const F box = V::max(V::abs(V::set1(query_.box_lo[k])), V::abs(V::set1(query_.box_hi[k])));
      largest = V::max(largest, V::max(V::abs(V::load(raw_[k])), box));
    }
    F slack = V::mul(V::set1(kAbsoluteSlack), largest);
    if constexpr (Leaf::kMoreSlack) {
      const F more = V::mul(V::set1(kFastSlack), reach_of_box());
      slack = V::add(slack, more);
      V::store(batch.tolerance, V::mul(V::set1(kFastTolerance), more));
    }
    F t0 = V::load(raw_[3]);
    F t1 = V::load(raw_[7]);
    V::store(batch.t_min, t0);
    V::store(batch.t_max, t1);
    V::store(batch.limit, V::set1(kEndless));
    V::store(batch.known, V::set1(kLaneNoHit));
    for (std::size_t k = 0; k < 3; ++k) {
      const F o = V::load(raw_[k]);
      const F inv = V::load(batch.inv_d[k]);
      const F lo = face(V::sub(V::set1(query_.box_lo[k]), o), slack, V::set1(-1.0F), inv);
      const F hi = face(V::sub(V::set1(query_.box_hi[k]), o), slack, V::set1(1.0F), inv);
      const M backward = V::lt(V::turn_sign(V::set1(1.0F), inv), V::set1(0.0F));
      t0 = V::max(V::blend(backward, lo, hi), t0);
      t1 = V::min(V::blend(backward, hi, lo), t1);
      V::store(batch.o[k], o);
    }
    V::store(batch.slack, slack);
    V::store(batch.t0, t0);
    V::store(batch.t1, t1);
    return V::bits(V::le(t0, t1));
  }

  static void keep_ends(std::uint32_t (&kept)[kW], const std::uint32_t* ids, const Batch& batch, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) kept[i] = ids[batch.index[i]];
  }

  // Of the root's box from the origin: its largest coordinate as seen from there.
  F reach_of_box() const {
    F reach = V::set1(0.0F);
    for (std::size_t k = 0; k < 3; ++k) {
      const F o = V::load(raw_[k]);
      reach = V::max(reach, V::max(V::abs(V::sub(V::set1(query_.box_lo[k]), o)),
                                   V::abs(V::sub(V::set1(query_.box_hi[k]), o))));
    }
    return reach;
  }

  static F face(F distance, F slack, F side, F inv_d) {
    const F e = V::add(slack, V::mul(V::set1(kRelativeSlack), V::abs(distance)));
    return V::mul(V::add(distance, V::turn_sign(e, side)), inv_d);
  }

  static constexpr std::uint32_t kPause = 7;

  const LaneQuery& query_;
  std::size_t next_ray_ = 0;
  std::uint32_t pause_ = 0;
  std::uint32_t at_ = kBatches - 1;
  std::uint64_t unusable_ = 0;
  alignas(64) float raw_[8][kW];
  Batch batches_[kBatches];
};

}  // namespace
}  // namespace raykiln::render
