// Making a Camera from what people write down.
#pragma once

#include <optional>
#include <string>

#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// Orthonormal camera at `eye` (world space, metres) towards `forward` (any length > 0), `up` not
/// parallel to it, fov_y_rad in (0, pi). `origin` is Scene::origin. Nothing when a value is not
/// finite, a direction vanishes, or up and forward are parallel to within 1e-6 rad.
[[nodiscard]] std::optional<Camera> make_camera(std::string name, const Vec3d& eye,
                                                const Vec3d& forward, const Vec3d& up,
                                                double fov_y_rad, const Vec3d& origin);

}  // namespace raykiln::render
