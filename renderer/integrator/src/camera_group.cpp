#include "camera_group.hpp"

#include <cstddef>

#include "lane_choice.hpp"
#include "raykiln/sampling/mix.hpp"

namespace raykiln::render {
namespace {

static_assert(sizeof(LaneStart) == sizeof(PathStart) && offsetof(LaneStart, y) == offsetof(PathStart, y) &&
              offsetof(LaneStart, sample) == offsetof(PathStart, sample));
static_assert(sizeof(LaneRay) == sizeof(Ray) && offsetof(LaneRay, t_min) == offsetof(Ray, t_min) &&
              offsetof(LaneRay, d) == offsetof(Ray, d) && offsetof(LaneRay, t_max) == offsetof(Ray, t_max));
static_assert(sizeof(LanePath) == sizeof(PathState) && offsetof(PathState, key) == 0 &&
              offsetof(LanePath, point) == offsetof(PathKey, point) &&
              offsetof(LanePath, throughput) == offsetof(PathState, throughput) &&
              offsetof(LanePath, scale) == offsetof(PathState, scale) &&
              offsetof(LanePath, pdf) == offsetof(PathState, pdf) &&
              offsetof(LanePath, node) == offsetof(PathState, node) &&
              offsetof(LanePath, slot) == offsetof(PathState, slot) &&
              offsetof(LanePath, bounce) == offsetof(PathState, bounce) &&
              offsetof(LanePath, met_diffuse) == offsetof(PathState, met_diffuse));

void put(double (&into)[3], const Vec3d& v) {
  for (int k = 0; k < 3; ++k) into[k] = v[k];
}

}  // namespace

CameraGroup::CameraGroup(const CameraRays& camera, const PathSettings& settings) {
  const auto pinhole = camera.pinhole();
  if (!pinhole || settings.pixel_filter != PixelFilter::kBox) return;
  kernel_ = kernel_with(settings.traversal, camera_kernel_avx512, camera_kernel_avx2);
  query_.seed_word = keyed::mix(settings.seed + keyed::kGolden, keyed::kRootTwo);  // the first line of path_key()
  query_.sobol = settings.sampler == Sampler::kSobol;
  query_.sobol_third = sobol::kThird.of_digits.front().data();
  query_.in_pixel = settings.pixel_mode == PixelMode::kRandom;
  query_.window_x = settings.window_x;
  query_.window_y = settings.window_y;
  put(query_.eye, pinhole->eye);
  put(query_.corner, pinhole->corner);
  put(query_.step_x, pinhole->step_x);
  put(query_.step_y, pinhole->step_y);
  put(query_.lo, pinhole->lo);
  put(query_.hi, pinhole->hi);
}

void CameraGroup::shoot(std::span<const PathStart> starts, std::uint32_t first_slot, PathStream& into) const {
  const std::size_t before = into.size();
  into.resize(before + starts.size(), false);
  CameraQuery query = query_;
  query.starts = reinterpret_cast<const LaneStart*>(starts.data());
  query.count = starts.size();
  query.first_slot = first_slot;
  query.rays = reinterpret_cast<LaneRay*>(into.rays().data() + before);
  query.paths = reinterpret_cast<LanePath*>(into.states().data() + before);
  kernel_(query);
}

}  // namespace raykiln::render
