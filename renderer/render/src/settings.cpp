#include <cmath>
#include <limits>

#include "raykiln/integrator/path_tracer.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::render {
namespace {

std::string between(const char* name, long long low, long long high) {
  return std::string(name) + " must be between " + std::to_string(low) + " and " +
         std::to_string(high);
}

std::optional<std::string> crop_error(const RenderSettings& s) {
  if (!s.crop) return std::nullopt;
  const Crop& crop = *s.crop;
  if (crop.full_width < 1 || crop.full_width > kLargestSide) return between("full_width", 1, kLargestSide);
  if (crop.full_height < 1 || crop.full_height > kLargestSide) return between("full_height", 1, kLargestSide);
  const bool inside = crop.x >= 0 && crop.y >= 0 && s.width <= crop.full_width - crop.x &&
                      s.height <= crop.full_height - crop.y;
  if (inside) return std::nullopt;
  return "the crop window leaves the whole picture";
}

}  // namespace

const Camera& camera_of(const RenderSettings& settings, const Scene& scene) {
  if (settings.own_camera) return *settings.own_camera;
  return scene.cameras[static_cast<std::size_t>(settings.camera)];
}

int path_limit(const RenderSettings& settings) {
  if (settings.max_depth) return *settings.max_depth;
  const bool one_ray = settings.branches == 1;
  return settings.light_model.roulette && one_ray ? kRouletteLimit : kFixedDepth;
}

std::uint64_t film_bytes(int width, int height) {
  if (width <= 0 || height <= 0) return 0;
  const double bytes = static_cast<double>(width) * height * static_cast<double>(Film::bytes_per_pixel());
  if (bytes >= 0x1p63) return std::numeric_limits<std::uint64_t>::max();
  return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
         Film::bytes_per_pixel();
}

SampleRelation sample_relation(Sampler sampler) {
  return sampler == Sampler::kRandom ? SampleRelation::kIndependent : SampleRelation::kByReplicates;
}

Film make_film(const RenderSettings& settings) {
  return {settings.width, settings.height, sample_relation(settings.sampler)};
}

std::optional<std::string> settings_error(const RenderSettings& settings, const Scene& scene) {
  const auto cameras = static_cast<long long>(scene.cameras.size());
  if (settings.width < 1 || settings.width > kLargestSide) return between("width", 1, kLargestSide);
  if (settings.height < 1 || settings.height > kLargestSide) {
    return between("height", 1, kLargestSide);
  }
  if (settings.camera < 0 || settings.camera >= cameras) {
    return "camera " + std::to_string(settings.camera) + " does not exist: the scene has " +
           std::to_string(cameras);
  }
  if (const auto wrong = crop_error(settings)) return wrong;
  const int depth = path_limit(settings);
  if (depth < 0 || depth > kLargestDepth) {
    return between("max_depth", 0, kLargestDepth);
  }
  if (settings.branches < 1 || settings.branches > kMostBranches) {
    return between("branches", 1, kMostBranches);
  }
  if (settings.branches > 1 &&
      rays_of_one_path(settings.branches, depth) > kMostRaysOfPath) {
    return "branches " + std::to_string(settings.branches) + " at max_depth " +
           std::to_string(depth) + " would shoot more than " +
           std::to_string(static_cast<long long>(kMostRaysOfPath)) +
           " rays for one sample; lower one of them";
  }
  return std::nullopt;
}

}  // namespace raykiln::render
