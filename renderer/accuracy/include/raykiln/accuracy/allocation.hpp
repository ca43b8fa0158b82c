// Where further samples lower the error of a picture most: a plan for cells of 16 x 16 pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "raykiln/image/film.hpp"

namespace raykiln::render {

/// Edge of the cells in pixels, whatever the tiles of a job are.
inline constexpr int kCellSide = 16;
/// Cells along a side of a picture, the last of which may be cut.
[[nodiscard]] constexpr int cells_across(int pixels) { return (pixels + kCellSide - 1) / kCellSide; }

/// No cell has less than this part of the samples that the picture has on average. It bounds what a cell can
/// lose whose samples have missed light so far, and with it the bias of choosing by the samples themselves.
inline constexpr double kLeastShareOfSamples = 0.25;

/// What the samples of a cell say of its noise.
struct CellNoise {
  double pixels = 0.0, samples = 0.0;  ///< how many; samples of each pixel
  double noise = 0.0;    ///< V: relative squares of one sample's noise, mean over pixels and channels
  double scatter = 0.0;  ///< variance of that estimate, as far as the samples tell
  bool known = true;     ///< every pixel has an estimate
};

/// Of each cell, row by row from the top left; a pure function of the film, whose pixels have one count in a cell.
[[nodiscard]] std::vector<CellNoise> cell_noise(const Film& film);

/// Samples a pixel that each cell should have next when the picture is to have `mean_samples` on average; never fewer than it
/// has, never more than `most`. `cells` are rows of `across`. The sum of V/n over cells is least where n is in proportion to
/// sqrt(V). What is known of V is not V: the share of noise in the scatter of sqrt(V) from cell to cell is the share of the samples that is
/// spent evenly, so that a picture whose cells differ by chance alone is sampled evenly, and no estimate costs more than one over that
/// share. Where a cell's own V hangs on few samples, it is drawn to the mean; and neighbours have their say: a cell in which
/// nothing has been found yet is as uncertain as what lies around it. Cells without an estimate get `mean_samples`.
[[nodiscard]] std::vector<std::uint64_t> place_samples(const std::vector<CellNoise>& cells, int across, double mean_samples,
                                                       std::uint64_t most);

/// place_samples() of cell_noise().
[[nodiscard]] std::vector<std::uint64_t> allocate_samples(const Film& film, double mean_samples, std::uint64_t most);

/// Samples a pixel that each cell has: those of its richest pixel, as a dropped sample makes none poorer.
[[nodiscard]] std::vector<std::uint64_t> cell_samples(const Film& film);

}  // namespace raykiln::render
