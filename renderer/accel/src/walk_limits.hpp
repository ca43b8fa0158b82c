// Constants that the scalar walk and the lane kernels share. Nothing here may be a function or have
// external linkage: units compiled for other instruction sets include it.
#pragma once

namespace raykiln::render {

/// Directions whose largest component is outside of these count as zero or infinite: no hit.
constexpr float kMinDirection = 0x1p-100F;
constexpr float kMaxDirection = 0x1p100F;

/// By how much a walk takes cells to be larger than they are: see scalar_walk.hpp.
constexpr float kAbsoluteSlack = 0x1p-43F;
constexpr float kRelativeSlack = 6.0F * 0x1p-24F;

/// Error of a float edge function: e = kFilterEdge m (h + kFilterCorner m) + kFilterUnderflow, see
/// triangle_test.hpp. Products below 2^-126 lose more than 2^-24 of themselves.
constexpr float kFilterEdge = 40.0F * 0x1p-24F;
constexpr float kFilterCorner = 4.0F * 0x1p-24F;
constexpr float kFilterUnderflow = 0x1p-120F;

}  // namespace raykiln::render
