#include "shadow_queue.hpp"

#include <chrono>

namespace raykiln::render {
namespace {

/// A wall behind the light must not block it, one just before it must: t of a hit is good to about
/// 3e-7 of itself, so the last 2^-20 of the way is left out. Relative, no absolute length.
constexpr float kShadowEnd = 1.0F - 0x1p-20F;

}  // namespace

void ShadowQueue::push(const Vec3f& from, const Vec3f& to, const Rgbd& light, std::uint32_t slot) {
  Ray ray;
  ray.o = from;
  ray.d = to - from;
  ray.t_max = kShadowEnd;
  rays_.push_back(ray);
  waiting_.push_back({light, slot});
}

void ShadowQueue::flush(const KdTree& tree, Traversal traversal, std::span<PathResult> results,
                        RenderStats& stats) {
  if (rays_.empty()) return;
  blocked_.resize(rays_.size());
  const auto start = std::chrono::steady_clock::now();
  any_hits(tree, rays_, blocked_, traversal, &stats.traversal);
  stats.traversal_seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  stats.shadow_rays += rays_.size();
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (blocked_[i] == Occlusion::kNone) results[waiting_[i].slot].direct += waiting_[i].light;
  }
  clear();
}

void ShadowQueue::clear() {
  rays_.clear();
  waiting_.clear();
}

}  // namespace raykiln::render
