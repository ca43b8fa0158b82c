// How the emitting triangle that a surface aims at is chosen.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raykiln::render {

/// Changes the noise of a picture and its time, never its mean.
enum class EmitterChoice : std::uint8_t {
  kAuto,   ///< kTree from kTreeFrom emitting triangles on, else kPower
  kPower,  ///< by power alone: the same for every surface, a table look-up
  kTree,   ///< by what may arrive at the surface in question: a way down a tree
};

/// Emitting triangles from which on kAuto takes the tree: measured, see tests/bench.
inline constexpr std::size_t kTreeFrom = 32;

}  // namespace raykiln::render
