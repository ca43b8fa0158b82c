// What all tasks of one build share: the mesh, the parameters, the way to stop and to report.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "build_kernels.hpp"
#include "raykiln/accel/kdtree.hpp"

namespace raykiln::render {

/// Elements handled between two looks at the stop request: about 50 us of work.
inline constexpr std::size_t kStopInterval = 8192;

class BuildContext {
 public:
  BuildContext(const TriangleView& mesh, const BuildParams& params, TaskRunner& runner);

  /// Sticky: once a stop was seen every loop of the build ends at its next look.
  [[nodiscard]] bool stopped();

  /// Calls body(begin, end) on pieces of [0, n) until done or stopped.
  template <typename Body>
  void in_pieces(std::size_t n, Body&& body) {
    for (std::size_t begin = 0; begin < n && !stopped(); begin += kStopInterval) {
      body(begin, begin + kStopInterval < n ? begin + kStopInterval : n);
    }
  }

  /// Runs body(i) for i in [0, n), as tasks when there is someone to run them.
  void for_each(std::size_t n, const std::function<void(std::size_t)>& body);

  /// Adds a share of the whole build, in [0, 1], to what the runner is told.
  void finished(double share);

  [[nodiscard]] std::array<Vec3f, 3> corners(std::uint32_t triangle) const {
    const auto& t = mesh.triangles[triangle];
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  }

  const BuildKernels& kernels;
  const TriangleView& mesh;
  const BuildParams params;  ///< made sane by the constructor
  TaskRunner& runner;
  const bool concurrent;  ///< cutting the work into tasks pays

 private:
  std::atomic<bool> stopped_{false};
  std::atomic<std::uint64_t> done_{0};      ///< in units of 2^-40 of the build
  std::atomic<std::uint64_t> reported_{0};  ///< in percent
};

/// Looks for a stop once in a while of counted work; one for each task.
class StopGauge {
 public:
  explicit StopGauge(BuildContext& context) : context_(context) {}
  [[nodiscard]] bool stopped_after(std::size_t work) {
    work_ += work;
    if (work_ < kGaugeInterval) return seen_;
    work_ = 0;
    return seen_ = context_.stopped();
  }

 private:
  static constexpr std::size_t kGaugeInterval = 512;
  BuildContext& context_;
  std::size_t work_ = 0;
  bool seen_ = false;
};

}  // namespace raykiln::render
