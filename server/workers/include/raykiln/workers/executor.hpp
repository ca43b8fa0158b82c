// Who renders a work item.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/result.hpp"
#include "raykiln/jobs/tile_plan.hpp"
#include "raykiln/render/render.hpp"

namespace raykiln::server {

/// All that rendering an item needs.
struct TileTask {
  std::string job;
  WorkItem item;
  std::shared_ptr<const render::PreparedScene> scene;
  render::RenderSettings settings;
  std::vector<render::SampleBlock> blocks;  ///< [item.first_block, item.end_block)
  std::stop_token stop;
};

/// What came of it. Errors: "worker_failed" (an exception), "worker_stopped" (the executor ends).
struct TileOutcome {
  std::string job;
  WorkItem item;
  std::vector<render::TileResult> results;  ///< one for each part of the item
  std::optional<Error> error{};
  bool stopped = false;    ///< stop was requested: nothing to merge
  int worker = 0;          ///< 0 .. concurrency() - 1
  double seconds = 0.0;    ///< spent rendering
  SteadyTime free_since{};  ///< when this worker ended the task before
  SteadyTime begun{}, ended{};
};

/// Runs tasks. Every start() is answered by exactly one `done`, on any thread, also when stopping.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void start(TileTask task, std::function<void(TileOutcome)> done) = 0;
  /// Tasks that run at once. Keep a few more started, so that no worker waits for the next.
  [[nodiscard]] virtual int concurrency() const = 0;
};

}  // namespace raykiln::server
