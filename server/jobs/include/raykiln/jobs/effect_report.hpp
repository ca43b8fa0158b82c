// What the renderer says about the effects of a scene or a job, in the words of the API.
#pragma once

#include <string>
#include <vector>

#include "raykiln/base/record.hpp"

namespace raykiln::server {

struct EffectLine {
  std::string name;  ///< "refraction"
  bool called_for = false;
  bool simulated = false;
  std::string evidence;  ///< the material, light or setting that decides
  /// Of leaving it out, where it is: "identical" if it is not called for, else "unbiased", "bounded"
  /// or "unbounded". Empty where it is simulated.
  std::string grade;
  std::string left_out;  ///< code, data and rays that are absent; empty where it is simulated
};

struct EffectReport {
  std::string label;  ///< marks pictures: "auto", "without=refraction (refraction bounded)"
  std::vector<EffectLine> lines;  ///< empty until the scene is known
};

/// Is something left out that the scene calls for?
[[nodiscard]] bool is_approximation(const EffectReport& report);

/// What a picture must say of itself: empty unless it is an approximation.
[[nodiscard]] std::string approximation_note(const EffectReport& report);

/// "point_lights,diffuse_reflection": the names of what is simulated.
[[nodiscard]] std::string simulated_names(const EffectReport& report);

void write_effects(RecordWriter& record, const EffectReport& report);
[[nodiscard]] EffectReport read_effects(const RecordReader& record);

}  // namespace raykiln::server
