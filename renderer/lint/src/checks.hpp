// The single checks; each appends what it finds.
#pragma once

#include <vector>

#include "raykiln/lint/lint.hpp"

namespace raykiln::render {

using Findings = std::vector<LintFinding>;

/// Triangles whose height is below 1e-4 of their longest edge, and edges of less than 16 float steps
/// of their coordinates.
void check_shapes(const Scene& scene, Findings& findings);

/// Surfaces of each refracting material, corners joined where their positions are equal: open edges,
/// edges of more than two triangles, neighbours wound against each other, closed bodies whose
/// normals face inwards.
void check_glass(const Scene& scene, Findings& findings);

}  // namespace raykiln::render
