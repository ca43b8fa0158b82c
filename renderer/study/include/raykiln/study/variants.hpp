// The knobs that trade accuracy for time, each turned once.
#pragma once

#include <string>
#include <vector>

#include "raykiln/render/render.hpp"

namespace raykiln::render {

/// One way of rendering the same view of the same scene.
struct Variant {
  std::string name;  ///< of the knob and its position: "fresnel=schlick"
  std::string what;  ///< for people, one line
  RenderSettings settings;
  BuildParams tree{};
};

/// The defaults first ("defaults": the unbiased physical model, whatever `view` asks for), then every
/// knob that this scene has, turned by itself, then a small grid of depth, emitters and Fresnel. A knob
/// that cannot change this picture is not listed. Size, camera and seed are those of `view`.
[[nodiscard]] std::vector<Variant> knob_variants(const RenderSettings& view, const Scene& scene);

}  // namespace raykiln::render
