// Is an error target kept, and what does placing samples where the error is save?
// Usage: bench_adaptive [--targets] [WIDTHxHEIGHT] [SEEDS[@SAMPLES]] [SCENE...]
// The target of a scene is the error that SAMPLES (256) everywhere have (rounded). Every seed stops as a job does: when the upper end of the
// interval of its error is at the target, judged at 64 samples and where jobs are; once with the same samples everywhere, once
// placed by cells. Truth is the mean of the other seeds' even pictures (Celarek et al. 2019), whose own noise is taken off.
// "gain" is the ratio of processor seconds times squared true error: time to equal error, as error^2 falls like 1/time; "gain_in_rays"
// the same with rays for seconds, which no other program disturbs, and its 95 % interval by the jackknife over seeds. Where a few bright samples
// make up the errors it wanders by half between seeds, and "gain_by_plan" says more: what even samples and the placed ones would leave of the noise
// of the cells that the even pictures of all other seeds have against the truth, so that the same bright samples weigh on both sides.
// "bound" is what the noise V of the cells and the rays c of their samples allow at most, without floor or caution: sum c sum V / (sum
// sqrt(c V))^2; "bound_in_samples" the same where a sample costs as much everywhere; "left" what the plan for 1024 samples on average leaves
// of it, made from 64 samples of another seed. With 0 SEEDS these alone, with --targets nothing adaptive.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "raykiln/accuracy/allocation.hpp"
#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/quantiles.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "raykiln/io/import.hpp"
#include "raykiln/scheduler/judge_picture.hpp"
#include "support/effect_scenes.hpp"

namespace {

using namespace raykiln::render;

constexpr std::uint64_t kFloor = 64, kMost = 1U << 16U;

struct Run {
  double render_seconds = 0.0, decide_seconds = 0.0, samples = 0.0, rays = 0.0;
  int decisions = 0;
  bool flagged = false;
  std::vector<std::uint64_t> cells;  ///< samples a pixel of each
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
    rays_.resize(rects_.size(), 0.0);
  }
  void advance(const std::vector<std::uint64_t>& limits) {
    for (std::size_t i = 0; i < rects_.size(); ++i) {
      std::vector<SampleBlock> blocks;
      for (SampleBlock b = sample_block(next_block_[i]); b.first + b.count <= limits[i]; b = sample_block(++next_block_[i])) {
        blocks.push_back(b);
      }
      if (blocks.empty()) continue;
      const TileResult result = render_tile(scene_, settings_, rects_[i], blocks, {});
      merge(film_, result);
      rays_[i] += static_cast<double>(result.stats.camera_rays + result.stats.bounce_rays + result.stats.shadow_rays);
      samples_ += static_cast<double>(rects_[i].pixels() * (blocks.back().first + blocks.back().count - blocks.front().first));
    }
  }
  [[nodiscard]] std::vector<std::uint64_t> even(std::uint64_t samples) const {
    return std::vector<std::uint64_t>(rects_.size(), samples);
  }
  [[nodiscard]] const Film& film() const { return film_; }
  [[nodiscard]] double mean_samples() const { return samples_ / settings_.width / settings_.height; }
  [[nodiscard]] const std::vector<double>& rays() const { return rays_; }  ///< of each cell so far

 private:
  const PreparedScene& scene_;
  RenderSettings settings_;
  Film film_;
  std::vector<PixelRect> rects_;
  std::vector<std::uint64_t> next_block_;
  std::vector<double> rays_;
  double samples_ = 0.0;
};

/// Samples at the first border of a block that has at least so many.
std::uint64_t border_at(std::uint64_t samples) {
  std::uint64_t end = 0;
  for (std::uint64_t i = 0; end < samples; ++i) end = sample_block(i).first + sample_block(i).count;
  return end;
}

Run run(const PreparedScene& scene, const RenderSettings& settings, double target, bool adaptive) {
  Cells cells(scene, settings);
  Run result;
  raykiln::server::JobRequest request;
  request.adaptive = adaptive;
  request.stop.samples = kMost;
  request.stop.error = target;
  std::uint64_t samples = kFloor;
  std::vector<std::uint64_t> limits = cells.even(samples);
  while (true) {
    const std::clock_t begun = std::clock();
    cells.advance(limits);
    result.render_seconds += seconds_since(begun);
    const std::clock_t deciding = std::clock();
    const raykiln::server::Decision decision = decide(cells.film(), request);
    result.decide_seconds += seconds_since(deciding);
    ++result.decisions;
    result.flagged = decision.error.heavy_tailed;
    if (target_met(request.stop, decision.error) || samples >= kMost) break;
    samples = border_at(raykiln::server::next_decision(samples));
    limits = adaptive ? decision.samples : cells.even(samples);
  }
  result.samples = cells.mean_samples();
  result.rays = std::accumulate(cells.rays().begin(), cells.rays().end(), 0.0);
  result.cells = cell_samples(cells.film());
  result.picture = pixel_errors(cells.film()).mean;
  return result;
}

/// The error of so many samples of a seed of its own, to two digits, and what the cells' noise allows at most.
struct Pilot {
  double target = 0.0, bound = 1.0, bound_in_samples = 1.0, left = 1.0;
};

/// What placing samples that cost c saves at most where noise is V: sum c sum V / (sum sqrt(c V))^2 (Cauchy-Schwarz).
double saving(const std::vector<double>& cost, const std::vector<double>& noise) {
  double costs = 0.0, noises = 0.0, roots = 0.0;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    costs += cost[i];
    noises += noise[i];
    roots += std::sqrt(cost[i] * noise[i]);
  }
  return costs * noises / (roots * roots);
}

/// The same for a plan n: sum c sum V / (sum c n sum V / n).
double saving(const std::vector<double>& cost, const std::vector<double>& noise, const std::vector<std::uint64_t>& plan) {
  double costs = 0.0, noises = 0.0, spent = 0.0, remaining = 0.0;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const auto n = static_cast<double>(plan[i]);
    costs += cost[i];
    noises += noise[i];
    spent += cost[i] * n;
    remaining += noise[i] / n;
  }
  return costs * noises / (spent * remaining);
}

Pilot pilot(const PreparedScene& scene, RenderSettings settings, std::uint64_t samples) {
  Cells cells(scene, settings);
  cells.advance(cells.even(border_at(samples)));
  const double error = image_error(cells.film()).error.value;
  if (!(error > 0.0)) return {};
  const double digit = std::pow(10.0, std::floor(std::log10(error)) - 1.0);
  std::vector<double> noise, pixels;
  for (const CellNoise& cell : cell_noise(cells.film())) {
    noise.push_back(cell.pixels * cell.noise);
    pixels.push_back(cell.pixels);
  }
  --settings.seed;
  Cells first(scene, settings);
  first.advance(first.even(kFloor));
  const auto plan = allocate_samples(first.film(), 1024.0, kMost);
  return {digit * std::ceil(error / digit), saving(cells.rays(), noise), saving(pixels, noise), saving(cells.rays(), noise, plan)};
}

/// Against the mean of the other even pictures of the same scene.
class Truths {
 public:
  Truths(const std::vector<Run>& even, const RenderSettings& settings)
      : even_(even), settings_(settings), sum_(even[0].picture.size()), own_noise_(1.0 / static_cast<double>(even.size() - 1)) {
    for (const Run& r : even) {
      for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += r.picture[i];
    }
    for (std::size_t s = 0; s < even.size(); ++s) {
      const std::vector<double> of_cells = squares_of_cells(even[s].picture, without(s));
      noise_.resize(of_cells.size());
      noise_of_.emplace_back();
      double square = 0.0;
      for (std::size_t c = 0; c < of_cells.size(); ++c) {
        square += of_cells[c] / static_cast<double>(sum_.size());
        noise_of_.back().push_back(of_cells[c] * static_cast<double>(even[s].cells[c]));
        noise_[c] += noise_of_.back().back();
      }
      of_even_ += square / (1.0 + own_noise_) / static_cast<double>(even.size());
    }
  }
  /// Of a picture of seed `s`, less the truth's own noise, which is a share of that of the even pictures.
  [[nodiscard]] double square(const Run& run, std::size_t s) const {
    return std::max(0.0, true_error(run.picture, without(s)).rel_mse - of_even_ * own_noise_);
  }
  /// What the samples of a run leave of the noise that cells have in all other seeds, but for a factor.
  [[nodiscard]] double left(const Run& run, std::size_t s) const {
    double left = 0.0;
    for (std::size_t c = 0; c < noise_.size(); ++c) left += (noise_[c] - noise_of_[s][c]) / static_cast<double>(run.cells[c]);
    return left;
  }

 private:
  [[nodiscard]] std::vector<double> without(std::size_t s) const {
    std::vector<double> truth(sum_.size());
    for (std::size_t i = 0; i < sum_.size(); ++i) truth[i] = (sum_[i] - even_[s].picture[i]) * own_noise_;
    return truth;
  }
  [[nodiscard]] std::vector<double> squares_of_cells(const std::vector<double>& picture, const std::vector<double>& truth) const {
    const double whole = std::accumulate(truth.begin(), truth.end(), 0.0) / static_cast<double>(truth.size());
    const int across = cells_across(settings_.width), down = cells_across(settings_.height);
    std::vector<double> squares(static_cast<std::size_t>(across * down));
    for (std::size_t i = 0; i < picture.size(); ++i) {
      const int pixel = static_cast<int>(i / 3), x = pixel % settings_.width, y = pixel / settings_.width;
      const double off = picture[i] - truth[i];
      squares[static_cast<std::size_t>(y / kCellSide * across + x / kCellSide)] += off * off / (truth[i] * truth[i] + 0.01 * whole * whole);
    }
    return squares;
  }

  const std::vector<Run>& even_;
  RenderSettings settings_;
  std::vector<double> sum_;
  double own_noise_;
  double of_even_ = 0.0;
  std::vector<std::vector<double>> noise_of_;  ///< for one sample, of each seed and cell
  std::vector<double> noise_;                  ///< the same, summed over the seeds
};

/// True errors over the target, their squares, and how many lie where they should.
struct Kept {
  double least = 1e9, largest = 0.0;
  std::vector<double> squares;
  int within = 0, flagged = 0;
};
Kept judge(const std::vector<Run>& runs, const Truths& truths, double target) {
  Kept kept;
  for (std::size_t s = 0; s < runs.size(); ++s) {
    kept.squares.push_back(truths.square(runs[s], s));
    const double ratio = std::sqrt(kept.squares.back()) / target;
    kept.within += ratio >= 0.7 && ratio <= 1.05 ? 1 : 0;
    kept.flagged += runs[s].flagged ? 1 : 0;
    kept.least = std::min(kept.least, ratio);
    kept.largest = std::max(kept.largest, ratio);
  }
  return kept;
}

/// sum of costs x sum of squares, even over placed, without seed `but`.
template <typename Cost>
double gain(const std::vector<Run>& even, const Kept& of_even, const std::vector<Run>& placed, const Kept& of_placed, Cost cost,
            std::size_t but = SIZE_MAX) {
  double e = 0.0, p = 0.0, e2 = 0.0, p2 = 0.0;
  for (std::size_t s = 0; s < even.size(); ++s) {
    if (s == but) continue;
    e += cost(even[s]);
    p += cost(placed[s]);
    e2 += of_even.squares[s];
    p2 += of_placed.squares[s];
  }
  return e * e2 / (p * p2);
}

/// Half of a 95 % interval of the logarithm of a gain: what each seed moves it by when left out.
template <typename Gain>
double log_interval(std::size_t seeds, Gain gain_without) {
  double mean = 0.0, squares = 0.0;
  const auto n = static_cast<double>(seeds);
  std::vector<double> logs;
  for (std::size_t s = 0; s < seeds; ++s) mean += logs.emplace_back(std::log(gain_without(s))) / n;
  for (const double log : logs) squares += (log - mean) * (log - mean);
  return student_t95(n - 1.0) * std::sqrt((n - 1.0) / n * squares);
}

struct Sums {
  double samples = 0.0, rays = 0.0, decisions = 0.0, render = 0.0, decide = 0.0;
};
Sums add_up(const std::vector<Run>& runs) {
  Sums sums;
  const auto n = static_cast<double>(runs.size());
  for (const Run& r : runs) {
    sums.samples += r.samples / n;
    sums.rays += r.rays / n;
    sums.decisions += r.decisions / n;
    sums.render += r.render_seconds / n;
    sums.decide += r.decide_seconds / n;
  }
  return sums;
}

struct Measured {
  std::string name;
  std::shared_ptr<const PreparedScene> scene;
  RenderSettings settings;
};

/// What is asked for of each scene.
struct Question {
  int seeds = 20, samples = 256;
  bool even_alone = false;
};

void measure(const Measured& what, const Question& asked, bool first) {
  const int seeds = asked.seeds;
  const PreparedScene& scene = *what.scene;
  RenderSettings settings = what.settings;
  settings.seed = 4999;
  const Pilot found = pilot(scene, settings, static_cast<std::uint64_t>(asked.samples));
  if (!(found.target > 0.0)) return;
  std::printf("%s  {\"scene\": \"%s\", \"target\": %.4g, \"bound\": %.3f, \"bound_in_samples\": %.3f, \"left\": %.3f, \"seeds\": %d",
              first ? "" : ",\n", what.name.c_str(), found.target, found.bound, found.bound_in_samples, found.left, seeds);
  std::fflush(stdout);
  if (seeds == 0) {
    std::printf("}");
    return;
  }
  std::vector<Run> even, placed;
  for (int seed = 0; seed < seeds; ++seed) {
    settings.seed = 5000 + static_cast<std::uint64_t>(seed);
    even.push_back(run(scene, settings, found.target, false));
    if (!asked.even_alone) placed.push_back(run(scene, settings, found.target, true));
  }
  const Truths truths(even, settings);
  const Kept of_even = judge(even, truths, found.target);
  const auto tell = [](const char* how, const Kept& k, const Sums& s) {
    std::printf(",\n   \"%s\": {\"samples\": %.1f, \"rays\": %.0f, \"render_seconds\": %.3f, \"decide_seconds\": %.3f, \"decisions\": %.1f, \"kept\": %d, "
                "\"flagged\": %d, \"least\": %.3f, \"largest\": %.3f}", how, s.samples, s.rays, s.render, s.decide, s.decisions, k.within, k.flagged,
                k.least, k.largest);
  };
  const Sums e = add_up(even);
  tell("even", of_even, e);
  if (!asked.even_alone) {
    const Kept of_placed = judge(placed, truths, found.target);
    const Sums p = add_up(placed);
    tell("adaptive", of_placed, p);
    const auto rays = [](const Run& r) { return r.rays; };
    const auto in_rays = [&](std::size_t but) { return gain(even, of_even, placed, of_placed, rays, but); };
    double e_left = 0.0, p_left = 0.0;
    for (std::size_t s = 0; s < even.size(); ++s) {
      e_left += truths.left(even[s], s);
      p_left += truths.left(placed[s], s);
    }
    const double half = log_interval(even.size(), in_rays), all = in_rays(SIZE_MAX);
    std::printf(",\n   \"gain\": %.3f, \"gain_in_rays\": %.3f, \"gain_low\": %.3f, \"gain_high\": %.3f, \"gain_by_plan\": %.3f",
                gain(even, of_even, placed, of_placed, [](const Run& r) { return r.seconds(); }), all, all * std::exp(-half), all * std::exp(half),
                e.rays / p.rays * e_left / p_left);
  }
  std::printf("}");
  std::fflush(stdout);
}

/// A scene of a folder, or one of the named ones; nothing when it is neither.
std::optional<Measured> scene_of(const std::string& what) {
  for (const auto& shown : support::named_effect_scenes()) {
    if (shown.name == what) return Measured{what, shown.builder.prepare(), shown.settings};
  }
  ImportResult imported = import_scene(DirectoryFiles(what));
  if (const auto* error = std::get_if<ImportError>(&imported)) {
    std::fprintf(stderr, "%s: %s\n", what.c_str(), error->message.c_str());
    return std::nullopt;
  }
  auto scene = std::make_shared<const Scene>(std::move(std::get<ImportedScene>(imported).scene));
  SerialTaskRunner runner;
  auto tree = build_scene_tree(*scene, {}, runner);
  return Measured{std::filesystem::path(what).filename().string(), prepare(std::move(scene), std::move(tree)), {}};
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> given(argv + 1, argv + argc);
  Question asked;
  asked.even_alone = !given.empty() && given[0] == "--targets";
  if (asked.even_alone) given.erase(given.begin());
  int width = 32, height = 32;
  if (!given.empty() && std::sscanf(given[0].c_str(), "%dx%d", &width, &height) != 2) width = height = 0;
  if (given.size() > 1 && std::sscanf(given[1].c_str(), "%d@%d", &asked.seeds, &asked.samples) < 1) asked.seeds = -1;
  if (width <= 0 || height <= 0 || asked.samples < 2 * static_cast<int>(kFloor) || (asked.seeds < 3 && asked.seeds != 0)) {
    std::puts("usage: bench_adaptive [--targets] [WIDTHxHEIGHT] [SEEDS[@SAMPLES]] [SCENE...]\n"
              "Whether error targets are kept, and time to equal error of samples placed by cells; JSON. With 0 seeds what\n"
              "placing samples can save at most. Defaults: 32x32 20@256 and\n"
              "the named scenes: matte_point_light diffuse_cornell everything. SCENE: one of them, or a folder.");
    return !given.empty() && given[0] == "--help" ? 0 : 2;
  }
  std::vector<std::string> scenes(given.begin() + std::min<std::ptrdiff_t>(2, std::ssize(given)), given.end());
  if (scenes.empty()) {
    for (const auto& shown : support::named_effect_scenes()) scenes.push_back(shown.name);
  }
  std::printf("{\"width\": %d, \"height\": %d, \"scenes\": [\n", width, height);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    auto scene = scene_of(scenes[i]);
    if (!scene) return 1;
    scene->settings.width = width;
    scene->settings.height = height;
    measure(*scene, asked, i == 0);
  }
  std::printf("\n]}\n");
  return 0;
}
