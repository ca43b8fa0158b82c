// Pictures by the threads that the server renders with.
#pragma once

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "raykiln/render/render.hpp"
#include "raykiln/workers/local_pool.hpp"

namespace raykiln::hard {

/// The film of `samples` samples, its rectangles rendered by a pool of `threads` in the given order.
inline render::Film film_by_pool(const std::shared_ptr<const render::PreparedScene>& scene,
                                 const render::RenderSettings& settings, std::uint64_t samples,
                                 int threads, const std::vector<render::PixelRect>& rects) {
  render::Film film(settings.width, settings.height);
  const auto blocks = render::blocks_for(samples);
  std::mutex mutex;
  std::atomic<std::size_t> answers{0};
  server::WorkerSettings pool_settings;
  pool_settings.threads = threads;
  server::LocalPool pool(pool_settings);
  for (const render::PixelRect& rect : rects) {
    server::TileTask task;
    task.job = "j";
    task.scene = scene;
    task.settings = settings;
    task.item.end_block = blocks.size();
    task.item.parts = {{0, {rect.x0, rect.y0, rect.x1, rect.y1}}};
    task.blocks = blocks;
    pool.start(std::move(task), [&](const server::TileOutcome& outcome) {
      const std::lock_guard lock(mutex);
      for (const render::TileResult& result : outcome.results) render::merge(film, result);
      ++answers;
    });
  }
  while (answers < rects.size()) std::this_thread::yield();
  pool.stop();
  return film;
}

/// Squares of `side` pixels that cover the picture.
inline std::vector<render::PixelRect> square_tiles(const render::RenderSettings& settings, int side) {
  std::vector<render::PixelRect> rects;
  for (int y = 0; y < settings.height; y += side) {
    for (int x = 0; x < settings.width; x += side) {
      rects.push_back({x, y, std::min(x + side, settings.width), std::min(y + side, settings.height)});
    }
  }
  return rects;
}

}  // namespace raykiln::hard
