#include <algorithm>
#include <vector>

#include "tracing.hpp"

namespace raykiln::render {
namespace {

constexpr std::size_t kWindowPaths = 32768;  ///< paths traced between two visits to the planes
constexpr std::size_t kMostLocated = 16;     ///< bad samples that a result names

/// A walk over all (block, sample, pixel) of a task, sample by sample, so that every pixel meets
/// its samples in rising order.
class TaskOrder {
 public:
  TaskOrder(const PixelRect& rect, std::span<const SampleBlock> blocks)
      : rect_(rect), blocks_(blocks), x_(rect.x0), y_(rect.y0) {
    skip_finished_blocks();
  }

  [[nodiscard]] bool done() const { return block_ == blocks_.size(); }
  [[nodiscard]] std::size_t block() const { return block_; }
  [[nodiscard]] std::size_t pixel() const { return pixel_; }
  [[nodiscard]] PathStart start() const { return {.x = x_, .y = y_, .sample = blocks_[block_].first + sample_}; }

  void step() {
    ++pixel_;
    if (++x_ < rect_.x1) return;
    x_ = rect_.x0;
    if (++y_ < rect_.y1) return;
    y_ = rect_.y0;
    pixel_ = 0;
    ++sample_;
    skip_finished_blocks();
  }

 private:
  void skip_finished_blocks() {
    while (block_ < blocks_.size() && sample_ >= blocks_[block_].count) {
      sample_ = 0;
      ++block_;
    }
  }

  PixelRect rect_;
  std::span<const SampleBlock> blocks_;
  std::size_t block_ = 0, pixel_ = 0;
  int x_, y_;
  std::uint64_t sample_ = 0;
};

/// Adds a traced sample to its block and keeps count of what was wrong with it. False when it was dropped.
bool keep(TileResult& result, const TaskOrder& at, const PathResult& path) {
  const Rgbd radiance = path.radiance();
  if (radiance.x < 0.0 || radiance.y < 0.0 || radiance.z < 0.0) ++result.stats.negative;
  if (add_sample(result.blocks[at.block()].planes, at.pixel(), radiance, path.truncated)) return true;
  ++result.stats.non_finite;
  if (result.bad_samples.size() < kMostLocated) {
    const PathStart start = at.start();
    result.bad_samples.push_back({start.x, start.y, start.sample});
  }
  return false;
}

/// Samples of all blocks and pixels, saturated.
std::size_t paths_of(const PixelRect& rect, std::span<const SampleBlock> blocks, std::size_t most) {
  std::uint64_t samples = 0;
  for (const SampleBlock& block : blocks) samples += std::min<std::uint64_t>(block.count, most);
  return samples >= most ? most : std::min(most, static_cast<std::size_t>(samples) * rect.pixels());
}

TileResult empty_result(const PixelRect& rect, std::span<const SampleBlock> blocks, const LayerSet& layers) {
  TileResult result;
  result.rect = rect;
  for (const SampleBlock& block : blocks) {
    result.blocks.push_back({.block = block, .planes = make_block_planes(rect.pixels())});
    if (!layers.empty()) result.layers.push_back(make_layer_block(block, layers, rect.pixels()));
  }
  return result;
}

}  // namespace

TileResult render_tile(const PreparedScene& scene, const RenderSettings& settings,
                       const PixelRect& rect, std::span<const SampleBlock> blocks,
                       std::stop_token stop) {
  TileResult result = empty_result(rect, blocks, settings.layers);
  if (rect.width() <= 0 || rect.height() <= 0) return result;
  if (!make_ready(scene, settings, stop)) {
    result.stopped = true;
    return result;
  }
  const CameraRays camera = camera_rays(scene, settings);
  PathTracer tracer(transport_scene(scene), camera,
                    path_settings(scene, settings));
  std::vector<PathStart> starts;
  std::vector<PathResult> paths;
  std::vector<LayerSample> layers;
  starts.reserve(paths_of(rect, blocks, kWindowPaths));
  TaskOrder order(rect, blocks);
  while (!order.done()) {
    TaskOrder traced = order;
    starts.clear();
    for (; !order.done() && starts.size() < kWindowPaths; order.step()) starts.push_back(order.start());
    paths.resize(starts.size());
    if (!settings.layers.empty()) layers.resize(starts.size());
    if (!tracer.trace(starts, paths, result.stats, stop, layers)) {
      result.stopped = true;
      return result;
    }
    for (std::size_t i = 0; i < starts.size(); ++i, traced.step()) {
      const bool counts = keep(result, traced, paths[i]);
      if (layers.empty()) continue;
      add_sample(result.layers[traced.block()], traced.pixel(), starts[i].sample, layers[i], counts);
    }
  }
  return result;
}

void merge(Film& film, const TileResult& result) {
  if (result.stopped) return;
  for (const BlockResult& block : result.blocks) film.fold(result.rect, block);
}

void merge(LayerFilm& film, const TileResult& result) {
  if (result.stopped) return;
  for (const LayerBlock& block : result.layers) film.fold(result.rect, block);
}

}  // namespace raykiln::render
