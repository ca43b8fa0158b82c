// One picture as two independent halves of equal length, rendered further on demand.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "raykiln/render/render.hpp"

namespace raykiln::render {

class HalfPictures {
 public:
  /// The halves are renders of these seeds.
  HalfPictures(std::shared_ptr<const PreparedScene> scene, const RenderSettings& settings,
               std::array<std::uint64_t, 2> seeds);

  /// Doubles the samples (the first time: one in each half).
  void advance(TaskRunner& runner);

  [[nodiscard]] std::uint64_t samples() const { return 2 * each_; }  ///< of both, a pixel
  [[nodiscard]] double seconds() const { return seconds_; }          ///< of one processor
  [[nodiscard]] std::vector<double> half(std::size_t which) const;   ///< means, 3 a pixel
  [[nodiscard]] std::vector<double> whole() const;

 private:
  std::shared_ptr<const PreparedScene> scene_;
  std::array<RenderSettings, 2> settings_;
  std::array<Film, 2> films_;
  std::uint64_t each_ = 0;
  double seconds_ = 0.0;
};

}  // namespace raykiln::render
