// Rays made ready for lanes, as many at a time as there are lanes: what `prepare` and the beginning
// of ScalarWalk do, with the same roundings. Internal linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_leaf.hpp"
#include "lane_query.hpp"
#include "walk_limits.hpp"

namespace raykiln::render {
namespace {

constexpr float kLargestFloat = 0x1.fffffep127F;

/// Rays that wait for a lane.
template <class V>
struct ReadyRays : LeafRays<V::kWidth> {
  static constexpr std::size_t kW = V::kWidth;
  float slack[kW], t0[kW], t1[kW];
  std::uint32_t backward[3];  ///< 1 for an axis along which the rays go down, if they go together
};

template <class V>
class RaySource {
 public:
  using F = typename V::F;
  using M = typename V::M;
  static constexpr std::size_t kW = V::kWidth;

  RaySource(const LaneQuery& query, bool together) : query_(query), together_(together) {
    for (std::size_t k = 0; k < 8; ++k) {
      for (std::size_t i = 0; i < kW; ++i) raw_[k][i] = 0.0F;
    }
  }

  /// The next ray that meets the root's box: its place in ready(), and its index. False at the end.
  /// Rays that go together are first given to walk_together(ready, lanes, index of lane 0), which
  /// gives those that are left.
  template <typename Together>
  bool next(std::size_t& place, std::size_t& index, Together&& walk_together) {
    while (waiting_ == 0) {
      if (next_ray_ == query_.ray_count) return false;
      prepare_some();
      begun_ = together_ && go_together();
      if (begun_) waiting_ = walk_together(ready_, waiting_, first_);
    }
    place = static_cast<std::size_t>(__builtin_ctz(waiting_));
    waiting_ &= waiting_ - 1;
    index = first_ + place;
    return true;
  }

  [[nodiscard]] const ReadyRays<V>& ready() const { return ready_; }
  /// True when the ray that next() gave was walked together with others first.
  [[nodiscard]] bool begun() const { return begun_; }
  [[nodiscard]] std::uint64_t unusable() const { return unusable_; }

 private:
  [[gnu::noinline]] void prepare_some() {
    const std::size_t left = query_.ray_count - next_ray_;
    const std::size_t n = left < kW ? left : kW;
    const float* rays = query_.rays + 8 * next_ray_;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < 8; ++k) raw_[k][i] = rays[8 * i + k];
    }
    const std::uint32_t given = n == 32 ? ~0U : (1U << n) - 1U;
    const std::uint32_t usable = shear() & given;
    unusable_ += n - static_cast<std::size_t>(__builtin_popcount(usable));
    waiting_ = usable != 0 ? enter_root() & usable : 0U;
    first_ = next_ray_;
    next_ray_ += n;
  }

  // Enough rays with the same signs of direction and the same main axis.
  bool go_together() {
    if (static_cast<std::size_t>(__builtin_popcount(waiting_)) * 2 < kW) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const M backward =
          V::lt(V::turn_sign(V::set1(1.0F), V::load(ready_.inv_d[k])), V::set1(0.0F));
      const std::uint32_t lanes = V::bits(backward) & waiting_;
      if (lanes != 0 && lanes != waiting_) return false;
      ready_.backward[k] = lanes != 0 ? 1U : 0U;
    }
    const std::uint64_t axis = ready_.shear[__builtin_ctz(waiting_)].main_axis;
    for (std::uint32_t rest = waiting_; rest != 0; rest &= rest - 1) {
      if (ready_.shear[__builtin_ctz(rest)].main_axis != axis) return false;
    }
    return true;
  }

  // The main axis and the slopes; a bit for every ray that can hit something.
  std::uint32_t shear() {
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
    V::store(ready_.sx, V::div(dx, dz));
    V::store(ready_.sy, V::div(dy, dz));
    keep_shear(axis, dx, dy, dz);
    const F most = V::set1(kMaxDirection);
    M usable = V::both(V::both(V::le(ax, most), V::le(ay, most)), V::le(az, most));
    usable = V::both(usable, V::le(V::set1(kMinDirection), V::abs(dz)));
    usable = V::both(usable, V::le(V::load(raw_[3]), V::load(raw_[7])));
    for (std::size_t k = 0; k < 3; ++k) {
      usable = V::both(usable, V::le(V::abs(V::load(raw_[k])), V::set1(kLargestFloat)));
      V::store(ready_.inv_d[k], V::div(V::set1(1.0F), d[k]));
    }
    return V::bits(usable);
  }

  // The slopes in double, as shear_ray has them.
  void keep_shear(typename V::I axis, F dx, F dy, F dz) {
    alignas(64) std::uint32_t axes[kW];
    alignas(64) double sx[kW], sy[kW], inv_dz[kW];
    V::store(axes, axis);
    V::store_quotients(sx, dx, dz);
    V::store_quotients(sy, dy, dz);
    V::store_quotients(inv_dz, V::set1(1.0F), dz);
    for (std::size_t i = 0; i < kW; ++i) ready_.shear[i] = {sx[i], sy[i], inv_dz[i], axes[i]};
  }

  // The interval within the root's box; a bit for every ray where it is not empty.
  std::uint32_t enter_root() {
    F largest = V::set1(0.0F);
    for (std::size_t k = 0; k < 3; ++k) {
      const F box = V::max(V::abs(V::set1(query_.box_lo[k])), V::abs(V::set1(query_.box_hi[k])));
      largest = V::max(largest, V::max(V::abs(V::load(raw_[k])), box));
    }
    const F slack = V::mul(V::set1(kAbsoluteSlack), largest);
    F t0 = V::load(raw_[3]);
    F t1 = V::load(raw_[7]);
    V::store(ready_.t_min, t0);
    V::store(ready_.t_max, t1);
    V::store(ready_.limit, V::set1(kEndless));
    V::store(ready_.known, V::set1(kLaneNoHit));
    for (std::size_t k = 0; k < 3; ++k) {
      const F o = V::load(raw_[k]);
      const F inv = V::load(ready_.inv_d[k]);
      const F lo = face(V::sub(V::set1(query_.box_lo[k]), o), slack, V::set1(-1.0F), inv);
      const F hi = face(V::sub(V::set1(query_.box_hi[k]), o), slack, V::set1(1.0F), inv);
      const M backward = V::lt(V::turn_sign(V::set1(1.0F), inv), V::set1(0.0F));
      t0 = V::max(V::blend(backward, lo, hi), t0);
      t1 = V::min(V::blend(backward, hi, lo), t1);
      V::store(ready_.o[k], o);
    }
    V::store(ready_.slack, slack);
    V::store(ready_.t0, t0);
    V::store(ready_.t1, t1);
    return V::bits(V::le(t0, t1));
  }

  static F face(F distance, F slack, F side, F inv_d) {
    const F e = V::add(slack, V::mul(V::set1(kRelativeSlack), V::abs(distance)));
    return V::mul(V::add(distance, V::turn_sign(e, side)), inv_d);
  }

  const LaneQuery& query_;
  std::size_t next_ray_ = 0, first_ = 0;
  std::uint32_t waiting_ = 0;
  const bool together_;  ///< whether rays may be walked together
  bool begun_ = false;
  std::uint64_t unusable_ = 0;
  alignas(64) float raw_[8][kW];
  ReadyRays<V> ready_;
};

}  // namespace
}  // namespace raykiln::render
