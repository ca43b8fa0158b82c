#include "raykiln/accuracy/allocation.hpp"

#include <algorithm>
#include <cmath>

#include "region_error.hpp"

namespace raykiln::render {
namespace {

/// Part of the largest wish among a cell and its eight neighbours that it is given at least. A half took most of what
/// there is to gain under a sky (1.57 of 1.80 in the gallery's metals, 1.75 with a quarter).
constexpr double kShareOfNeighbours = 0.25;
constexpr int kBisections = 60;  ///< for the one factor that all wishes are multiplied by

/// sqrt(V) of a cell and the variance of that: of V through the slope of the root.
struct Wish {
  double value = 0.0, variance = 0.0;
};
Wish wish_of(const CellNoise& cell) {
  if (!cell.known || !(cell.noise > 0.0)) return {};
  return {std::sqrt(cell.noise), cell.scatter / (4.0 * cell.noise)};
}

/// Mean over the pixels of cells that have an estimate; 0 without any.
template <typename Value>
double mean_of(const std::vector<CellNoise>& cells, Value value) {
  double pixels = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].known) continue;
    pixels += cells[i].pixels;
    sum += cells[i].pixels * value(i);
  }
  return pixels > 0.0 ? sum / pixels : 0.0;
}

/// Raised towards the neighbours' where theirs are far larger.
std::vector<double> with_neighbours(const std::vector<double>& own, int across) {
  const int down = static_cast<int>(own.size()) / across;
  std::vector<double> wishes = own;
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) {
      double& wish = wishes[static_cast<std::size_t>(y * across + x)];
      for (int v = std::max(0, y - 1); v <= std::min(down - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(across - 1, x + 1); ++u) {
          wish = std::max(wish, kShareOfNeighbours * own[static_cast<std::size_t>(v * across + u)]);
        }
      }
    }
  }
  return wishes;
}

/// What to multiply into samples; the mean is a cell's of even samples.
std::vector<double> wishes_of(const std::vector<CellNoise>& cells, int across) {
  std::vector<Wish> seen;
  for (const CellNoise& cell : cells) seen.push_back(wish_of(cell));
  const double mean = mean_of(cells, [&](std::size_t i) { return seen[i].value; });
  const double noise = mean_of(cells, [&](std::size_t i) { return seen[i].variance; });
  const auto known = static_cast<double>(std::count_if(cells.begin(), cells.end(), [](const CellNoise& c) { return c.known; }));
  const double spread = mean_of(cells, [&](std::size_t i) { return (seen[i].value - mean) * (seen[i].value - mean); }) * known / std::max(1.0, known - 1.0);
  // Of all cells: one that has missed what is rare looks surer than it is, and knows only from the others that it is not.
  const double even = spread > noise ? noise / spread : 1.0, real = std::max(0.0, spread - noise);
  std::vector<double> wishes;
  for (const Wish& wish : seen) {
    const double own = wish.variance > 0.0 ? wish.variance / (wish.variance + real) : 0.0;
    const double further = own > even ? (own - even) / (1.0 - even) : 0.0;  // with the even share it makes up `own`
    wishes.push_back(wish.value + further * (mean - wish.value));
  }
  wishes = with_neighbours(wishes, across);
  const double raised = mean_of(cells, [&](std::size_t i) { return wishes[i]; });
  for (double& wish : wishes) wish += even * (raised - wish);
  return wishes;
}

double samples_of(const CellNoise& cell, double wish, double factor, double mean, double most) {
  const double wanted = cell.known ? std::max(kLeastShareOfSamples * mean, factor * wish) : mean;
  return std::max(cell.samples, std::min(most, wanted));
}

}  // namespace

std::vector<CellNoise> cell_noise(const Film& film) {
  const int width = film.width(), height = film.height();
  Survey survey;
  for (std::size_t i = 0; i < static_cast<std::size_t>(width) * static_cast<std::size_t>(height); ++i) {
    survey.add(pixel_statistics(film, i));
  }
  std::vector<CellNoise> cells;
  for (int y = 0; y < height; y += kCellSide) {
    for (int x = 0; x < width; x += kCellSide) {
      const PixelRect rect{x, y, std::min(x + kCellSide, width), std::min(y + kCellSide, height)};
      CellNoise cell{.pixels = static_cast<double>(rect.pixels())};
      for (int v = rect.y0; v < rect.y1; ++v) {
        for (int u = rect.x0; u < rect.x1; ++u) {
          const PixelStatistics pixel = pixel_statistics(
              film, static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u));
          cell.samples = std::max(cell.samples, static_cast<double>(pixel.samples));  // a dropped sample does not make a pixel poorer
          cell.known = cell.known && pixel.known;
        }
      }
      const NoiseSum sum = noise_of_one_sample(film, rect, survey.floor());
      const double values = 3.0 * cell.pixels;
      cell.noise = sum.value / values;
      cell.scatter = sum.variance / (values * values);
      cells.push_back(cell);
    }
  }
  return cells;
}

std::vector<std::uint64_t> place_samples(const std::vector<CellNoise>& cells, int across, double mean_samples,
                                         std::uint64_t most) {
  const std::vector<double> wishes = wishes_of(cells, across);
  const double largest = *std::max_element(wishes.begin(), wishes.end()), cap = static_cast<double>(most);
  const auto total = [&](double factor) {
    double sum = 0.0;
    for (std::size_t i = 0; i < wishes.size(); ++i) {
      sum += cells[i].pixels * samples_of(cells[i], wishes[i], factor, mean_samples, cap);
    }
    return sum;
  };
  double wanted = 0.0;
  for (const CellNoise& cell : cells) wanted += mean_samples * cell.pixels;
  double low = 0.0, high = largest > 0.0 ? 1.0 : 0.0;
  while (high > 0.0 && total(high) < wanted && high * largest < 1e30) high *= 2.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (total(middle) < wanted ? low : high) = middle;
  }
  std::vector<std::uint64_t> samples;
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    samples.push_back(static_cast<std::uint64_t>(std::ceil(samples_of(cells[i], wishes[i], high, mean_samples, cap))));
  }
  return samples;
}

std::vector<std::uint64_t> allocate_samples(const Film& film, double mean_samples, std::uint64_t most) {
  return place_samples(cell_noise(film), cells_across(film.width()), mean_samples, most);
}

std::vector<std::uint64_t> cell_samples(const Film& film) {
  const int across = cells_across(film.width()), down = cells_across(film.height());
  std::vector<std::uint64_t> samples(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  std::size_t i = 0;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x, ++i) {
      auto& most = samples[static_cast<std::size_t>(y / kCellSide * across + x / kCellSide)];
      most = std::max(most, film.pixel(i).samples());
    }
  }
  return samples;
}

}  // namespace raykiln::render
