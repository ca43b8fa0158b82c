#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raykiln/image/film.hpp"

namespace raykiln::render {
namespace {

constexpr std::array<PlaneSpec, BlockPlane::kCount> kBlockSpecs{{
    {"beauty", 3, Fold::kSum},
    {"samples", 1, Fold::kSum},
    {"luminance_moment", 1, Fold::kMoments},
    {"moment", 3, Fold::kMoments},
    {"largest", 1, Fold::kMax},
    {"nan", 1, Fold::kSum},
    {"inf", 1, Fold::kSum},
    {"negative", 1, Fold::kSum},
    {"truncated", 1, Fold::kSum},
}};

constexpr std::array<PlaneSpec, BlockPlane::kCount + 2> kFilmSpecs{{
    kBlockSpecs[BlockPlane::kBeauty],
    kBlockSpecs[BlockPlane::kSamples],
    kBlockSpecs[BlockPlane::kLuminanceMoment],
    kBlockSpecs[BlockPlane::kMoment],
    kBlockSpecs[BlockPlane::kLargest],
    kBlockSpecs[BlockPlane::kNan],
    kBlockSpecs[BlockPlane::kInf],
    kBlockSpecs[BlockPlane::kNegative],
    kBlockSpecs[BlockPlane::kTruncated],
    {"luminance_count", kReplicates, Fold::kSum},
    {"luminance_sum", kReplicates, Fold::kSum},
}};

bool any_nan(const Rgbd& c) { return std::isnan(c.x) || std::isnan(c.y) || std::isnan(c.z); }

/// Written so that it holds for every finite float32 value.
bool fits_float(const Rgbd& c) {
  constexpr double kLimit = std::numeric_limits<float>::max();
  return std::abs(c.x) <= kLimit && std::abs(c.y) <= kLimit && std::abs(c.z) <= kLimit;
}

}  // namespace

std::span<const PlaneSpec> block_planes() { return kBlockSpecs; }
std::span<const PlaneSpec> film_planes() { return kFilmSpecs; }

PlaneSet make_block_planes(std::size_t pixels) {
  PlaneSet set;
  set.planes.reserve(kBlockSpecs.size());
  for (const PlaneSpec& spec : kBlockSpecs) {
    set.planes.emplace_back(pixels * static_cast<std::size_t>(spec.channels), 0.0);
  }
  return set;
}

bool add_sample(PlaneSet& block, std::size_t pixel, const Rgbd& radiance, bool truncated) {
  auto& planes = block.planes;
  if (truncated) planes[BlockPlane::kTruncated][pixel] += 1.0;
  if (any_nan(radiance)) {
    planes[BlockPlane::kNan][pixel] += 1.0;
    return false;
  }
  if (!fits_float(radiance)) {
    planes[BlockPlane::kInf][pixel] += 1.0;
    return false;
  }
  if (radiance.x < 0.0 || radiance.y < 0.0 || radiance.z < 0.0) planes[BlockPlane::kNegative][pixel] += 1.0;

  double* beauty = &planes[BlockPlane::kBeauty][3 * pixel];
  const double y = luminance(radiance);
  const double count_before = planes[BlockPlane::kSamples][pixel];
  if (count_before > 0.0) {
    // Welford's update, written with the sums: M += (x - mean)^2 n / (n + 1).
    // Divisions, not a reciprocal: equal samples have a deviation of exactly 0.
    const double weight = count_before / (count_before + 1.0);
    const double deviation = y - luminance({beauty[0], beauty[1], beauty[2]}) / count_before;
    planes[BlockPlane::kLuminanceMoment][pixel] += deviation * deviation * weight;
    double* moment = &planes[BlockPlane::kMoment][3 * pixel];
    for (int c = 0; c < 3; ++c) {
      const double of_channel = radiance[c] - beauty[c] / count_before;
      moment[c] += of_channel * of_channel * weight;
    }
  }
  beauty[0] += radiance.x;
  beauty[1] += radiance.y;
  beauty[2] += radiance.z;
  planes[BlockPlane::kSamples][pixel] += 1.0;
  planes[BlockPlane::kLargest][pixel] = std::max(planes[BlockPlane::kLargest][pixel], y);
  return true;
}

}  // namespace raykiln::render
