#include "shadow_queue.hpp"

#include <algorithm>
#include <chrono>

namespace raykiln::render {
namespace {

/// The end of a surface's ray is lifted off it: hits at t >= 1 are that surface, hits at t < 1 block.
constexpr float kBeforeSurface = 1.0F - 0x1p-24F;

/// A point light cannot be lifted off what it lies in. d = light - o is rounded by u |d_i| for each
/// coordinate (u = 2^-24), which moves the far end of the ray; so a surface of normal n in which the
/// light lies is met at 1 + e, |e| <= u sum |n_i d_i| / |n.d| + u, the last u for rounding t. That is
/// 2 u where n is an axis, and at most (1 + 1/sin s) u under an angle s to the surface. 16 u
/// therefore keep a surface through the light from blocking it under any angle if it lies across an
/// axis, and down to 3.9 degrees if not; what stands in the way is overlooked only within 16 u =
/// 9.5e-7 of the distance before the light. Relative to the way, no length of its own.
constexpr float kBeforePointLight = 1.0F - 16.0F * 0x1p-24F;

}  // namespace

void ShadowQueue::push(const Way& way, const Rgbd& light, std::uint32_t slot) {
  Ray ray;
  ray.o = way.from;
  if (way.end == ShadowEnd::kInfinity) {
    ray.d = way.to;
  } else {
    ray.d = way.to - way.from;
    ray.t_max = way.end == ShadowEnd::kSurface ? kBeforeSurface : kBeforePointLight;
  }
  make_room(size_ + 1);
  rays_[size_] = ray;
  waiting_[size_] = {light, slot};
  from_[size_] = way.from_triangle;
  to_[size_] = way.to_triangle;
  ++size_;
}

void ShadowQueue::make_room(std::size_t size) {
  if (size <= rays_.size()) return;
  rays_.resize(std::max(size, 2 * rays_.size()));
  waiting_.resize(rays_.size());
  from_.resize(rays_.size());
  to_.resize(rays_.size());
}

ShadowQueue::Room ShadowQueue::open(std::size_t most) {
  make_room(size_ + most);
  std::fill_n(from_.data() + size_, most, kNoHit);
  std::fill_n(to_.data() + size_, most, kNoHit);
  return {size_, rays_.data() + size_, waiting_.data() + size_, from_.data() + size_, to_.data() + size_};
}

void ShadowQueue::close(const Room& room, std::size_t count) { size_ = room.first + count; }

void ShadowQueue::flush(const KdTree& tree, Traversal traversal, std::span<PathResult> results,
                        RenderStats& stats, const Gaps& gaps) {
  if (size_ == 0) return;
  if (gaps.any()) return flush_through_gaps(tree, traversal, gaps, results, stats);
  blocked_.resize(size_);
  const auto start = std::chrono::steady_clock::now();
  any_hits(tree, rays(), blocked_, traversal, &stats.traversal, ends());
  stats.traversal_seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  stats.shadow_rays += size_;
  for (std::size_t i = 0; i < size_; ++i) {
    if (blocked_[i] == Occlusion::kNone) results[waiting_[i].slot].direct += waiting_[i].light;
  }
  clear();
}

// What of the light each surface lets through is multiplied, nothing is drawn: a draw would add noise.
void ShadowQueue::flush_through_gaps(const KdTree& tree, Traversal traversal, const Gaps& gaps,
                                     std::span<PathResult> results, RenderStats& stats) {
  hits_.resize(size_);
  share_.assign(size_, 1.0);
  const auto start = std::chrono::steady_clock::now();
  closest_hits(tree, rays(), hits_, {}, traversal, &stats.traversal, ends());
  gap_walk_.go_on(
      tree, traversal, rays(), hits_, stats,
      [&](std::size_t i, const Hit& hit) {
        share_[i] *= 1.0 - gaps.met(place_of(hit), Vec3d(rays_[i].d));
        return !(share_[i] > 0.0);
      },
      [&](std::size_t i) {
        share_[i] = 0.0;
        results[waiting_[i].slot].truncated = true;
      });
  stats.traversal_seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  stats.shadow_rays += size_;
  for (std::size_t i = 0; i < size_; ++i) {
    if (share_[i] > 0.0) results[waiting_[i].slot].direct += waiting_[i].light * share_[i];
  }
  clear();
}

void ShadowQueue::clear() { size_ = 0; }

}  // namespace raykiln::render
