// Where further samples lower the error of a picture most: a plan for cells of 16 x 16 pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Edge of the cells in pixels, whatever the tiles of a job are.
inline constexpr int kCellSide = 16;

/// No cell has less than this part of the samples that the picture has on average. It bounds what a cell can
/// lose whose samples have missed light so far, and with it the bias of choosing by the samples themselves.
inline constexpr double kLeastShareOfSamples = 0.25;

/// Samples a pixel that each cell should have next, row by row from the top left, when the picture is to have
/// `mean_samples` on average; never fewer than it has, never more than `most`. With V the relative squares of a
/// cell's noise for one sample, the sum of V/n over cells is least where n is in proportion to sqrt(V / pixels).
/// V is taken over the cell, and from its neighbours where they have far more: a cell in which nothing has been
/// found yet is as uncertain as what lies around it. A pure function of the film, whose pixels have one count in a cell. Cells
/// without an estimate keep what they have and get `mean_samples`.
[[nodiscard]] std::vector<std::uint64_t> allocate_samples(const Film& film, double mean_samples, std::uint64_t most);

/// Samples a pixel that each cell has: those of its richest pixel, as a dropped sample makes none poorer.
[[nodiscard]] std::vector<std::uint64_t> cell_samples(const Film& film);

}  // namespace raykiln::render
