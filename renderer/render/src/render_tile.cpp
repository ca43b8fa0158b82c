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
      : rect_(rect), blocks_(blocks) {}

  struct Item {
    std::size_t block = 0, pixel = 0;
    PathStart start;
  };

  [[nodiscard]] bool done() const { return block_ == blocks_.size(); }

  [[nodiscard]] Item item() const {
    const auto width = static_cast<std::size_t>(rect_.width());
    return {.block = block_,
            .pixel = pixel_,
            .start = {.x = rect_.x0 + static_cast<int>(pixel_ % width),
                      .y = rect_.y0 + static_cast<int>(pixel_ / width),
                      .sample = blocks_[block_].first + sample_}};
  }

  void step() {
    if (++pixel_ < rect_.pixels()) return;
    pixel_ = 0;
    ++sample_;
    skip_finished_blocks();
  }

  void skip_finished_blocks() {
    while (block_ < blocks_.size() && sample_ >= blocks_[block_].count) {
      sample_ = 0;
      ++block_;
    }
  }

 private:
  PixelRect rect_;
  std::span<const SampleBlock> blocks_;
  std::size_t block_ = 0, pixel_ = 0;
  std::uint64_t sample_ = 0;
};

/// Adds a traced sample to its block and keeps count of what was wrong with it. False when it was dropped.
bool keep(TileResult& result, const TaskOrder::Item& item, const PathResult& path) {
  const Rgbd radiance = path.radiance();
  if (radiance.x < 0.0 || radiance.y < 0.0 || radiance.z < 0.0) ++result.stats.negative;
  if (add_sample(result.blocks[item.block].planes, item.pixel, radiance, path.truncated)) return true;
  ++result.stats.non_finite;
  if (result.bad_samples.size() < kMostLocated) {
    result.bad_samples.push_back({item.start.x, item.start.y, item.start.sample});
  }
  return false;
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
  const CameraRays camera = camera_rays(scene, settings);
  PathTracer tracer({scene.scene(), scene.tree(), scene.emitters(), &scene.pyramids()}, camera,
                    path_settings(scene, settings));
  std::vector<TaskOrder::Item> items;
  std::vector<PathStart> starts;
  std::vector<PathResult> paths;
  std::vector<LayerSample> layers;
  TaskOrder order(rect, blocks);
  order.skip_finished_blocks();
  while (!order.done()) {
    items.clear();
    starts.clear();
    for (; !order.done() && items.size() < kWindowPaths; order.step()) {
      items.push_back(order.item());
      starts.push_back(items.back().start);
    }
    paths.resize(items.size());
    if (!settings.layers.empty()) layers.resize(items.size());
    if (!tracer.trace(starts, paths, result.stats, stop, layers)) {
      result.stopped = true;
      return result;
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      const bool counts = keep(result, items[i], paths[i]);
      if (layers.empty()) continue;
      add_sample(result.layers[items[i].block], items[i].pixel, items[i].start.sample, layers[i], counts);
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
