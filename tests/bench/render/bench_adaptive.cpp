// Is an error target kept, and what does placing samples where the error is save?
// Usage: bench_adaptive [SIDE_PX] [SEEDS] [SCENE_FOLDER]
// The target of a scene is the error that 256 samples everywhere have (rounded). Every seed stops as a job does: when the upper end of the
// interval of its error is at the target, judged at 64 samples and after each tenth more; once with the same samples everywhere, once
// placed by cells. Truth is the mean of the other seeds' even pictures (Celarek et al. 2019), whose own noise is taken off.
// "gain" is the ratio of processor seconds times squared true error: time to equal error, as error^2 falls like 1/time.
// "bound" is what the noise of the cells allows at most: (sum of V) / (sum of sqrt V)^2 times cells, without floor or caution.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "raykiln/accuracy/allocation.hpp"
#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "raykiln/io/import.hpp"
#include "support/effect_scenes.hpp"

namespace {

using namespace raykiln::render;

constexpr std::uint64_t kFloor = 64, kMost = 1U << 16U;

struct Run {
  double render_seconds = 0.0, decide_seconds = 0.0, samples = 0.0, shown = 0.0;
  bool flagged = false, met = false;
  std::vector<double> picture;
  [[nodiscard]] double seconds() const { return render_seconds + decide_seconds; }
};

double seconds_since(std::clock_t start) { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }

/// Cells of a picture, each at the border of a block.
class Cells {
 public:
  Cells(const PreparedScene& scene, const RenderSettings& settings)
      : scene_(scene), settings_(settings), film_(make_film(settings)) {
    for (int y = 0; y < settings.height; y += kCellSide) {
      for (int x = 0; x < settings.width; x += kCellSide) {
        rects_.push_back({x, y, std::min(x + kCellSide, settings.width), std::min(y + kCellSide, settings.height)});
      }
    }
    next_block_.resize(rects_.size(), 0);
  }
  void advance(const std::vector<std::uint64_t>& limits) {
    for (std::size_t i = 0; i < rects_.size(); ++i) {
      std::vector<SampleBlock> blocks;
      for (SampleBlock b = sample_block(next_block_[i]); b.first + b.count <= limits[i]; b = sample_block(++next_block_[i])) {
        blocks.push_back(b);
      }
      if (blocks.empty()) continue;
      merge(film_, render_tile(scene_, settings_, rects_[i], blocks, {}));
      samples_ += static_cast<double>(rects_[i].pixels() * (blocks.back().first + blocks.back().count - blocks.front().first));
    }
  }
  [[nodiscard]] std::vector<std::uint64_t> even(std::uint64_t samples) const {
    return std::vector<std::uint64_t>(rects_.size(), samples);
  }
  [[nodiscard]] const Film& film() const { return film_; }
  [[nodiscard]] double mean_samples() const { return samples_ / settings_.width / settings_.height; }

 private:
  const PreparedScene& scene_;
  RenderSettings settings_;
  Film film_;
  std::vector<PixelRect> rects_;
  std::vector<std::uint64_t> next_block_;
  double samples_ = 0.0;
};

Run run(const PreparedScene& scene, const RenderSettings& settings, double target, bool adaptive) {
  Cells cells(scene, settings);
  Run result;
  double mean = kFloor;
  std::vector<std::uint64_t> limits = cells.even(kFloor);
  while (true) {
    const std::clock_t begun = std::clock();
    cells.advance(limits);
    result.render_seconds += seconds_since(begun);
    const std::clock_t deciding = std::clock();
    const ImageError error = image_error(cells.film());
    result.flagged = error.heavy_tailed;
    result.met = error.error.high <= target;
    result.shown = error.error.value;
    const bool enough = result.met || mean > kMost;
    mean *= 1.1;
    if (!enough) limits = adaptive ? allocate_samples(cells.film(), mean, kMost) : cells.even(static_cast<std::uint64_t>(mean));
    result.decide_seconds += seconds_since(deciding);
    if (enough) break;
  }
  result.samples = cells.mean_samples();
  result.picture = pixel_errors(cells.film()).mean;
  return result;
}

/// The error of 256 samples of a seed of its own, to two digits, and what the cells' noise allows at most.
struct Pilot {
  double target = 0.0, bound = 1.0;
};
Pilot pilot(const PreparedScene& scene, const RenderSettings& settings) {
  Cells cells(scene, settings);
  cells.advance(cells.even(256));
  const double error = image_error(cells.film()).error.value;
  if (!(error > 0.0)) return {};
  const double digit = std::pow(10.0, std::floor(std::log10(error)) - 1.0);
  const PixelErrors errors = pixel_errors(cells.film());
  double whole = 0.0;
  for (const double mean : errors.mean) whole += mean / static_cast<double>(errors.mean.size());
  const int across = (settings.width + kCellSide - 1) / kCellSide;
  std::vector<double> noise(cells.even(0).size()), pixels(noise.size());
  for (int y = 0; y < settings.height; ++y) {
    for (int x = 0; x < settings.width; ++x) {
      const auto cell = static_cast<std::size_t>(y / kCellSide * across + x / kCellSide);
      const auto i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(settings.width) + static_cast<std::size_t>(x));
      pixels[cell] += 1.0;
      for (std::size_t c = i; c < i + 3; ++c) {
        const double mean = errors.mean[c], e = errors.standard_error[c];
        if (e > 0.0) noise[cell] += e * e / (mean * mean + 0.01 * whole * whole);
      }
    }
  }
  double sum = 0.0, roots = 0.0, all = 0.0;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    sum += noise[i];
    roots += std::sqrt(noise[i] * pixels[i]);
    all += pixels[i];
  }
  return {digit * std::ceil(error / digit), sum * all / (roots * roots)};
}

/// True errors over the target, their mean square, and how many lie where they should.
struct Kept {
  double least = 1e9, largest = 0.0, mean_square = 0.0;
  int within = 0, flagged = 0;
};
Kept judge(const std::vector<Run>& runs, const std::vector<Run>& even, double target) {
  Kept kept;
  const auto n = static_cast<double>(even.size());
  std::vector<double> sum(even[0].picture.size()), truth(sum.size());
  for (const Run& r : even) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += r.picture[i];
  }
  double of_even = 0.0;  // mean square of the even pictures: the truth's own noise is a share of it
  for (const Run& r : even) {
    for (std::size_t i = 0; i < sum.size(); ++i) truth[i] = (sum[i] - r.picture[i]) / (n - 1.0);
    of_even += true_error(r.picture, truth).rel_mse / (1.0 + 1.0 / (n - 1.0)) / n;
  }
  for (std::size_t s = 0; s < runs.size(); ++s) {
    for (std::size_t i = 0; i < sum.size(); ++i) truth[i] = (sum[i] - even[s].picture[i]) / (n - 1.0);
    const double square = std::max(0.0, true_error(runs[s].picture, truth).rel_mse - of_even / (n - 1.0));
    const double ratio = std::sqrt(square) / target;
    kept.within += ratio >= 0.7 && ratio <= 1.05 ? 1 : 0;
    kept.flagged += runs[s].flagged ? 1 : 0;
    kept.least = std::min(kept.least, ratio);
    kept.largest = std::max(kept.largest, ratio);
    kept.mean_square += square / static_cast<double>(runs.size());
  }
  return kept;
}

struct Sums {
  double samples = 0.0, render = 0.0, decide = 0.0;
};
Sums add_up(const std::vector<Run>& runs) {
  Sums sums;
  const auto n = static_cast<double>(runs.size());
  for (const Run& r : runs) {
    sums.samples += r.samples / n;
    sums.render += r.render_seconds / n;
    sums.decide += r.decide_seconds / n;
  }
  return sums;
}

void measure(const std::string& name, const PreparedScene& scene, RenderSettings settings, int side, int seeds, bool& first) {
  settings.width = settings.height = side;
  settings.seed = 4999;
  const Pilot found = pilot(scene, settings);
  if (!(found.target > 0.0)) return;
  std::vector<Run> even, placed;
  for (int seed = 0; seed < seeds; ++seed) {
    settings.seed = 5000 + static_cast<std::uint64_t>(seed);
    even.push_back(run(scene, settings, found.target, false));
    placed.push_back(run(scene, settings, found.target, true));
  }
  const Kept of_even = judge(even, even, found.target), of_placed = judge(placed, even, found.target);
  const Sums e = add_up(even), p = add_up(placed);
  const double gain = (e.render + e.decide) * of_even.mean_square / ((p.render + p.decide) * of_placed.mean_square);
  std::printf("%s  {\"scene\": \"%s\", \"target\": %.4g, \"seeds\": %d, \"gain\": %.3f, \"bound\": %.3f", first ? "" : ",\n", name.c_str(),
              found.target, seeds, gain, found.bound);
  first = false;
  const auto tell = [](const char* what, const Kept& k, const Sums& s) {
    std::printf(",\n   \"%s\": {\"samples\": %.1f, \"render_seconds\": %.3f, \"decide_seconds\": %.3f, \"kept\": %d, \"flagged\": %d, "
                "\"least\": %.3f, \"largest\": %.3f}", what, s.samples, s.render, s.decide, k.within, k.flagged, k.least, k.largest);
  };
  tell("even", of_even, e);
  tell("adaptive", of_placed, p);
  std::printf("}");
  std::fflush(stdout);
}

int number(int argc, char** argv, int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; }

}  // namespace

int main(int argc, char** argv) {
  const int side = number(argc, argv, 1, 32), seeds = number(argc, argv, 2, 20);
  if (side <= 0 || seeds < 3) {
    std::puts("usage: bench_adaptive [SIDE_PX] [SEEDS] [SCENE_FOLDER]\n"
              "Whether error targets are kept, and time to equal error of samples placed by cells; JSON. Defaults: 32 20.");
    return argc > 1 && std::string_view(argv[1]) == "--help" ? 0 : 2;
  }
  std::printf("{\"side_px\": %d, \"scenes\": [\n", side);
  bool first = true;
  if (argc > 3) {
    ImportResult imported = import_scene(DirectoryFiles(argv[3]));
    if (const auto* error = std::get_if<ImportError>(&imported)) {
      std::fprintf(stderr, "%s: %s\n", argv[3], error->message.c_str());
      return 1;
    }
    auto scene = std::make_shared<const Scene>(std::move(std::get<ImportedScene>(imported).scene));
    SerialTaskRunner runner;
    auto tree = build_scene_tree(*scene, {}, runner);
    measure("demo", *prepare(std::move(scene), std::move(tree)), {}, side, seeds, first);
  }
  for (const auto& shown : support::named_effect_scenes()) {
    measure(shown.name, *shown.builder.prepare(), shown.settings, side, seeds, first);
  }
  std::printf("\n]}\n");
  return 0;
}
