// What does placing samples where the error is save, against the same number everywhere?
// Usage: bench_adaptive [SIDE_PX] [ERROR] [SCENE_FOLDER]
// One thread. Both run until their estimated error is ERROR (0.04), judged at 64 samples and after each tenth more.
// Their true errors are then taken against a picture of other seeds with 8 times the samples; "gain" is the ratio of
// seconds times squared error: time to equal error, as error^2 falls like 1/time.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <vector>

#include "raykiln/accuracy/allocation.hpp"
#include "raykiln/accuracy/image_error.hpp"
#include "raykiln/accuracy/pixel_error.hpp"
#include "raykiln/accuracy/true_error.hpp"
#include "raykiln/io/import.hpp"
#include "support/small_rooms.hpp"

namespace {

using namespace raykiln::render;

constexpr std::uint64_t kFloor = 64, kMost = 1U << 16U;

struct Run {
  double render_seconds = 0.0, decide_seconds = 0.0, samples = 0.0, true_error = 0.0;
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
    const bool enough = image_error(cells.film()).error.value <= target || mean > kMost;
    mean *= 1.1;
    if (!enough) limits = adaptive ? allocate_samples(cells.film(), mean, kMost) : cells.even(static_cast<std::uint64_t>(mean));
    result.decide_seconds += seconds_since(deciding);
    if (enough) break;
  }
  result.samples = cells.mean_samples();
  result.picture = pixel_errors(cells.film()).mean;
  return result;
}

void measure(const char* name, const PreparedScene& scene, RenderSettings settings, double target, const char* comma) {
  Run even = run(scene, settings, target, false), placed = run(scene, settings, target, true);
  settings.seed += 1000;
  Cells reference(scene, settings);
  reference.advance(reference.even(static_cast<std::uint64_t>(8.0 * even.samples)));
  const std::vector<double> truth = pixel_errors(reference.film()).mean;
  even.true_error = true_error(even.picture, truth).error;
  placed.true_error = true_error(placed.picture, truth).error;
  const double gain = even.seconds() * even.true_error * even.true_error / (placed.seconds() * placed.true_error * placed.true_error);
  std::printf("  {\"scene\": \"%s\", \"gain\": %.3f,\n", name, gain);
  for (const auto& [what, r] : {std::pair<const char*, const Run&>{"even", even}, {"adaptive", placed}}) {
    std::printf("   \"%s\": {\"samples\": %.1f, \"render_seconds\": %.3f, \"decide_seconds\": %.3f, \"true_error\": %.4f}%s\n", what,
                r.samples, r.render_seconds, r.decide_seconds, r.true_error, &r == &even ? "," : "");
  }
  std::printf("  }%s\n", comma);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::atoi(argv[1]) <= 0) {
    std::puts("usage: bench_adaptive [SIDE_PX] [ERROR] [SCENE_FOLDER]\n"
              "Time to equal error of samples placed by cells against the same number everywhere; JSON. Defaults: 96 0.04.");
    return std::string_view(argv[1]) == "--help" ? 0 : 2;
  }
  RenderSettings settings;
  settings.width = settings.height = argc > 1 ? std::atoi(argv[1]) : 96;
  const double target = argc > 2 ? std::atof(argv[2]) : 0.04;
  std::printf("{\"side_px\": %d, \"target\": %g, \"scenes\": [\n", settings.width, target);
  if (argc > 3) {
    ImportResult imported = import_scene(DirectoryFiles(argv[3]));
    if (const auto* error = std::get_if<ImportError>(&imported)) {
      std::fprintf(stderr, "%s: %s\n", argv[3], error->message.c_str());
      return 1;
    }
    auto scene = std::make_shared<const Scene>(std::move(std::get<ImportedScene>(imported).scene));
    SerialTaskRunner runner;
    auto tree = build_scene_tree(*scene, {}, runner);
    measure(argv[3], *prepare(std::move(scene), std::move(tree)), settings, target, ",");
  }
  measure("diffuse_with_area_light", *support::diffuse_with_area_light().prepare(), settings, target, ",");
  measure("lamp_over_a_slit", *support::lamp_over_a_slit().prepare(), settings, 3.0 * target, ",");
  measure("glass_with_caustic", *support::glass_with_caustic().prepare(), settings, 3.0 * target, "");
  std::printf("]}\n");
  return 0;
}
