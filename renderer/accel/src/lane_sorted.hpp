// The walk of a small tree: rays are sorted by main axis and signs of direction, and all walk as
// packets, however few of them meet a cell. In a tree of few cells most do, and the triangles of a
// leaf are then tested against many rays at once. Counts are those of the scalar walk. Internal
// linkage only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lane_query.hpp"
#include "lane_setup.hpp"

namespace raykiln::render {
namespace {

template <class V, class Source, class Packets, std::uint32_t kPackets>
class SortedWalk {
 public:
  SortedWalk(const LaneQuery& query, Source& source, Packets& packets)
      : query_(query), source_(source), packets_(packets) {}

  void run() {
    for (std::size_t i = 0; i < query_.ray_count; ++i) {
      const float* const ray = query_.rays + 8 * i;
      const std::size_t kind = main_axis(ray) * 8 + signs(ray);
      Kind& same = kinds_[kind];
      same.index[same.size++] = i;
      if (same.size == V::kWidth) take(kind);
    }
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      if (kinds_[kind].size != 0) take(kind);
    }
    if (ready_ != 0) walk();
  }

 private:
  static constexpr std::size_t kKinds = 24;
  struct Kind {
    std::size_t index[V::kWidth];
    std::size_t size = 0;
  };

  // As triangle_test.hpp has it.
  static std::size_t main_axis(const float* ray) {
    const float ax = __builtin_fabsf(ray[4]);
    const float ay = __builtin_fabsf(ray[5]);
    const float az = __builtin_fabsf(ray[6]);
    const unsigned not_x = 1U - (static_cast<unsigned>(ax >= ay) & static_cast<unsigned>(ax >= az));
    return not_x * (2U - static_cast<unsigned>(ay >= az));
  }

  static std::size_t signs(const float* ray) {
    std::uint32_t bits[3];
    __builtin_memcpy(bits, ray + 4, sizeof bits);
    return (bits[0] >> 31) | (bits[1] >> 31) << 1 | (bits[2] >> 31) << 2;
  }

  void take(std::size_t kind) {
    Kind& same = kinds_[kind];
    ReadyRays<V>& batch = batches_[ready_];
    for (std::size_t i = 0; i < same.size; ++i) batch.index[i] = same.index[i];
    source_.prepare(batch, same.size);
    same.size = 0;
    if (batch.waiting == 0) return;
    for (std::size_t k = 0; k < 3; ++k) {
      batch.backward[k] = static_cast<std::uint32_t>(kind >> k & 1U);
    }
    if (++ready_ == kPackets) walk();
  }

  void walk() {
    packets_.walk(batches_, (1U << ready_) - 1U, true);
    ready_ = 0;
  }

  const LaneQuery& query_;
  Source& source_;
  Packets& packets_;
  Kind kinds_[kKinds];
  std::uint32_t ready_ = 0;
  ReadyRays<V> batches_[kPackets];
};

}  // namespace
}  // namespace raykiln::render
