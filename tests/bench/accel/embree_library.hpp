// Embree 4 as a measure to compare with: loaded at run time, declared here as far as it is used.
// Neither the product nor a test needs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::bench {

/// The values are Embree's.
enum class EmbreeQuality : int { kMedium = 1, kHigh = 2 };

/// The triangles of a mesh in an Embree scene. Rays are traced on the thread that asks.
class EmbreeScene {
 public:
  virtual ~EmbreeScene() = default;
  /// rtcIntersect1 for every ray; t, id, u, v of a miss as in render::Hit.
  virtual void closest(std::span<const render::Ray> rays, std::span<render::Hit> hits) const = 0;
  /// rtcIntersect16, marked as coherent.
  virtual void closest16(std::span<const render::Ray> rays, std::span<render::Hit> hits) const = 0;
  /// rtcOccluded1 for every ray.
  virtual void any(std::span<const render::Ray> rays, std::span<render::Occlusion> hits) const = 0;
};

class EmbreeLibrary {
 public:
  virtual ~EmbreeLibrary() = default;
  /// `robust`: Embree's watertight test. nullptr when Embree fails.
  [[nodiscard]] virtual std::unique_ptr<EmbreeScene> build(const render::TriangleView& mesh,
                                                           EmbreeQuality quality,
                                                           bool robust) const = 0;
  [[nodiscard]] virtual std::string version() const = 0;
};

/// It builds on `threads` threads, the caller's among them. nullptr, and the reason on standard error, when the file is
/// no Embree 4.
[[nodiscard]] std::unique_ptr<EmbreeLibrary> load_embree(const std::string& path, int threads);

}  // namespace raykiln::bench
