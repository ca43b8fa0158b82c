// What passes between the builder and the parts of it that are compiled once for each instruction
// set. Plain data and pointers only, as in lane_query.hpp. All kernels do the same operations, so
// that what they give is the same, bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raykiln::render {

/// Bins across an axis of a cell; with the two of its faces they fit into a byte.
inline constexpr std::size_t kMaxBins = 240;
/// Up to so many references the sides of every plane are counted.
inline constexpr std::size_t kCountingMax = 32;

/// References as the kernels see them: eight words each, lo.xyz, id, hi.xyz, nothing.
using ReferenceWords = const float*;

/// Cost of planes across one axis in float: step + (cap + side x) N_left + (cap + side (1 - x)) N_right
/// for a plane at the share x of the cell's width, good to a few 10^-7 of all that is summed. The cost
/// of a test is part of cap and side.
struct RoughCost {
  float step, cap, side, empty_factor;
  bool usable;  ///< no number of it over- or underflows
};

/// A small cell.
struct CountingQuery {
  ReferenceWords references;
  std::uint32_t n;
  std::int32_t affordable;  ///< references that the parts may have together
  float cell_lo[3], cell_hi[3], per_width[3];
  RoughCost cost[3];
  float leaf;               ///< planes that cost more for certain are left out
};

/// A plane that may be the cheapest, with the triangles before it, behind it and in it.
struct CountedPlane {
  float position, least;    ///< on either side of it those in the plane cost as much or more
  std::uint32_t n_left, n_right, n_planar, axis;
};
inline constexpr std::size_t kMostCountedPlanes = 3 * 2 * kCountingMax;

struct CountedPlanes {
  CountedPlane* planes;
  std::size_t size;
  std::uint64_t operations;  ///< comparisons, four as one
};

/// The ends of extents in a bin of a larger cell, at most kCountingMax of each kind.
struct BinPlanesQuery {
  const float *lows, *highs, *planars;  ///< an extent that is planar has both ends, too
  std::uint32_t n_lows, n_highs, n_planars;
  std::int32_t n_left, n_right;  ///< triangles before and behind the bin, or through it
  std::int32_t n, affordable;    ///< of the cell
  std::uint32_t axis;
  float cell_lo, cell_hi, per_width;
  RoughCost cost;
  float threshold;  ///< planes that cost more for certain are left out
  float beyond;     ///< the same for those beyond the budget
};

/// Positions in a cell to bins: see BinGrid.
struct BinScale {
  float lo[4], hi[4], scale[4], last[4];
};

/// Where a reference begins and ends: a byte each for the bins of lo.x, lo.y, lo.z, then from the
/// fifth on of hi.x, hi.y, hi.z, the lowest first.
using BinCode = std::uint64_t;

struct BinTables {
  std::uint32_t* starts[3];
  std::uint32_t* ends[3];
};

/// Bounds on the cost of all planes in each bin of an axis, bins 1 to `bins`.
struct BinBoundsQuery {
  const std::uint32_t* starts;
  const std::uint32_t* ends;
  std::size_t bins;
  std::uint32_t n;
  std::int32_t budget;       ///< references that a split may add
  RoughCost cost;
  bool edges_known;          ///< the bins are where their numbers say, but for 2^-12 of a bin
};
struct BinBounds {
  /// Extents that begin and that end before a bin.
  std::int32_t n_left[kMaxBins + 2], n_gone[kMaxBins + 2];
  /// No plane of the bin costs less; infinite for a bin without planes.
  float least[kMaxBins + 1];
};

/// References cut in two by a plane across an axis.
struct SplitQuery {
  float position;
  std::uint32_t axis, planar_left;  ///< 1: what lies in the plane goes left
};
inline constexpr std::size_t kSplitBlock = 128;
struct SplitCounts {
  /// A reference that was written to both sides, at these places.
  struct Both {
    std::uint32_t left, right;
  };
  Both both[kSplitBlock + 1];
  std::uint32_t n_both, left, right;
};

/// Two parts of a cell, x y z and a zero of the lower and upper corner each, and the mesh.
struct ClipQuery {
  const float* positions;  ///< three words a vertex
  const std::uint32_t* triangles;
  float left[2][4], right[2][4];
  std::uint32_t axis;  ///< the parts differ there
};
/// The id of a reference to nothing.
inline constexpr std::uint32_t kNoReference = 0xFFFFFFFFU;

struct BuildKernels {
  /// Planes across all axes that may be the cheapest, or as cheap: among them all that are.
  void (*count_planes)(const CountingQuery& query, CountedPlanes& result);
  /// The same across one axis, within a bin.
  void (*count_planes_of_bin)(const BinPlanesQuery& query, CountedPlanes& result);
  /// Counts extents in bins and writes the codes of the references.
  void (*count_bins)(const BinScale& scale, ReferenceWords references, std::size_t n, BinCode* codes,
                     const BinTables& tables);
  /// Writes the places of codes with a byte in first + [0, span] where `axes` is set, and up to four
  /// places more; gives their number. There are less than 2^16 codes.
  std::size_t (*find_codes)(const BinCode* codes, std::size_t n, BinCode first, BinCode span,
                            BinCode axes, std::uint16_t* found);
  /// Gives a cost that the axis' cheapest plane does not exceed.
  float (*bound_bins)(const BinBoundsQuery& query, BinBounds& bounds);
  /// Writes up to kSplitBlock references to the sides where they lie, in order, and one behind them.
  /// `left` may be `from` or before it.
  void (*split_references)(const SplitQuery& query, ReferenceWords from, std::uint32_t n, float* left,
                           float* right, SplitCounts& result);
  /// Gives references on both sides the bounds of the triangle's part there; where it is empty they
  /// become kNoReference. Bits: all left ones are there, all right ones.
  unsigned (*clip_references)(const ClipQuery& query, const SplitCounts::Both* both, std::uint32_t n,
                              float* left, float* right);
  /// Writes the bounds of the part of a triangle, nine words, in a cell; false when it is empty.
  bool (*clip_triangle)(const float* corners, const float (&cell)[2][4], float* to);
};

/// The fastest that the processor can run, or the one for every processor by RAYKILN_KERNEL=scalar.
const BuildKernels& build_kernels();
/// nullptr where this build has none or the processor cannot run them.
const BuildKernels* avx2_build_kernels();

extern const BuildKernels kAnyBuildKernels;
extern const BuildKernels kAvx2BuildKernels;  ///< only where RAYKILN_X86_KERNELS is set

}  // namespace raykiln::render
