// Constants that the scalar walk and the lane kernels share. Nothing here may be a function or have
// external linkage: units compiled for other instruction sets include it.
#pragma once

namespace raykiln::render {

/// Directions whose largest component is outside of these count as zero or infinite: no hit.
constexpr float kMinDirection = 0x1p-100F;
constexpr float kMaxDirection = 0x1p100F;
constexpr float kLargestFloat = 0x1.fffffep127F;

/// By how much a walk takes cells to be larger than they are: see scalar_walk.hpp.
constexpr float kAbsoluteSlack = 0x1p-43F;
constexpr float kRelativeSlack = 6.0F * 0x1p-24F;

/// Error of a float edge function: e = kFilterEdge m (h + kFilterCorner m) + kFilterUnderflow, see
/// triangle_test.hpp. Products below 2^-126 lose more than 2^-24 of themselves.
constexpr float kFilterEdge = 40.0F * 0x1p-24F;
constexpr float kFilterCorner = 4.0F * 0x1p-24F;
constexpr float kFilterUnderflow = 0x1p-120F;

/// What the test of the interval in lane_filter.hpp allows for underflow: of products of edge
/// functions with depths or bounds, and of t to zero. 2^-116 and 2^-149 would do; but a product that
/// is subnormal itself costs the processor more than the whole test.
constexpr float kVanishingProduct = 0x1p-90F;
constexpr float kVanishingT = 0x1p-60F;

/// For the fast test cells are larger still, by this much of the reach of the root's box from the
/// origin: see fast_test.hpp. Weights are formed anew in double where they leave a ray by more than
/// kFastTolerance of that, or where the determinant has no inverse.
constexpr float kFastSlack = 0x1p-18F;
constexpr float kFastTolerance = 0.5F;
constexpr float kFastLargestDeterminant = 0x1p100F;

}  // namespace raykiln::render
