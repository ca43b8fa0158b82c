// Camera rays, shot several at once where the processor can.
#pragma once

#include <cstdint>
#include <span>

#include "camera_query.hpp"
#include "path_stream.hpp"
#include "raykiln/integrator/path_tracer.hpp"

namespace raykiln::render {

class CameraGroup {
 public:
  CameraGroup(const CameraRays& camera, const PathSettings& settings);

  /// False where there is no kernel, or the rays are others than it knows: those of lenses, of parallel
  /// projections, of filters but the box.
  [[nodiscard]] bool ready() const { return kernel_ != nullptr; }

  /// Pushes a path for each of `starts`, whose results are those from `first_slot` on; rays and states alone.
  void shoot(std::span<const PathStart> starts, std::uint32_t first_slot, PathStream& into) const;

 private:
  CameraKernel kernel_ = nullptr;
  CameraQuery query_{};  ///< what does not change from call to call
};

}  // namespace raykiln::render
