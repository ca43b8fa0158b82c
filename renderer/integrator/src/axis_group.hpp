// Vertices on mirrors and clear borders, set aside while a step shades the others, and shaded several at once where
// the processor can.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "axis_query.hpp"
#include "transport.hpp"
#include "vertex_shading.hpp"

namespace raykiln::render {

class AxisGroup {
 public:
  /// Reads what the kernel needs from `transport`, which outlives the group.
  explicit AxisGroup(const Transport& transport);

  AxisGroup(const AxisGroup&) = delete;
  AxisGroup& operator=(const AxisGroup&) = delete;

  /// May this vertex be set aside? Never, where there is no kernel or the settings ask for more than it knows.
  [[nodiscard]] bool takes(const Hit& hit, const PathState& state) const {
    return kernel_ != nullptr && hit.id != kNoHit && of_axes_[mesh_.material_ids[hit.id]] != 0 && state.bounce < max_depth_;
  }

  /// Sets vertex `place` of the range aside; true when there are enough to be shaded.
  [[nodiscard]] bool add(std::size_t place) {
    chosen_.push_back(static_cast<std::uint32_t>(place));
    return chosen_.size() >= kBatch;
  }

  /// Shades those that were set aside, and returns the places of the few that are left to the scalar code: light of an
  /// emitter's point may come along an axis of theirs. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> shade(const Transport& transport, const ShadingRange& range,
                                                     ShadingSinks& sinks);

 private:
  static constexpr std::size_t kBatch = 256;

  void read_materials(const std::vector<Material>& materials);
  void read_lights(const Transport& transport);

  const TriangleMesh& mesh_;
  int max_depth_ = 0;
  AxisKernel kernel_ = nullptr;
  AxisQuery query_{};  ///< what does not change from call to call
  std::vector<std::uint8_t> of_axes_;  ///< a material: is it of this kind?
  std::vector<LaneAxisMaterial> materials_;
  std::vector<double> lights_;
  std::vector<std::uint32_t> chosen_, left_;
};

}  // namespace raykiln::render
