// Vertices on flat, diffuse, opaque surfaces, set aside while a step shades the others, and shaded several at
// once where the processor can.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "matte_query.hpp"
#include "transport.hpp"
#include "vertex_shading.hpp"

namespace raykiln::render {

class MatteGroup {
 public:
  /// Reads what the kernel needs from `transport`, which outlives the group.
  explicit MatteGroup(const Transport& transport);

  MatteGroup(const MatteGroup&) = delete;
  MatteGroup& operator=(const MatteGroup&) = delete;

  /// May this vertex be set aside? Never, where there is no kernel or the settings ask for more than it knows.
  [[nodiscard]] bool takes(const Hit& hit, const PathState& state) const {
    return kernel_ != nullptr && hit.id != kNoHit && plain_[mesh_.material_ids[hit.id]] != 0 &&
           state.bounce < max_depth_ && flat(hit.id);
  }

  /// Sets vertex `i` of the range aside; shades all of them when there are enough.
  void add(std::size_t i, const Transport& transport, const ShadingRange& range, ShadingSinks& sinks) {
    chosen_.push_back(static_cast<std::uint32_t>(i - range.begin));
    if (chosen_.size() >= batch_) shade(transport, range, sinks);
  }

  /// Shades what is left.
  void shade(const Transport& transport, const ShadingRange& range, ShadingSinks& sinks);

 private:
  [[nodiscard]] bool flat(std::uint32_t triangle) const {
    if (corner_normals_ == nullptr) return true;
    const auto& corner = corner_normals_[triangle];
    return corner[0] == kNoNormal || corner[1] == kNoNormal || corner[2] == kNoNormal;
  }
  void read_materials(const std::vector<Material>& materials);
  void read_lights(const Transport& transport);

  const TriangleMesh& mesh_;
  const std::array<std::uint32_t, 3>* corner_normals_ = nullptr;
  int max_depth_ = 0;
  std::size_t batch_ = 0;  ///< vertices shaded together
  MatteKernel kernel_ = nullptr;
  MatteQuery query_{};     ///< what does not change from call to call
  std::vector<std::uint8_t> plain_;  ///< a material: is it of this kind?
  std::vector<float> diffuse_, emission_;
  std::vector<double> pdf_area_;
  std::vector<double> casters_;  ///< four a body: centre and radius
  std::vector<LanePointLight> lights_;
  std::vector<std::uint32_t> chosen_;
};

}  // namespace raykiln::render
