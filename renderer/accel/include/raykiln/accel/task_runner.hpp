// How the renderer gets work done in parallel without starting a thread.
#pragma once

#include <functional>
#include <span>

namespace raykiln::render {

/// Runs closures for the renderer. Implemented serially here and by the worker pool of the server.
class TaskRunner {
 public:
  virtual ~TaskRunner() = default;

  /// Runs every closure once, in any order and on any thread, and returns when all have ended.
  /// May be called from inside a closure. An exception of a closure is rethrown here.
  virtual void run(std::span<const std::function<void()>> tasks) = 0;

  /// `fraction` in [0, 1] of the running operation; called rarely, from any thread.
  virtual void progress(double fraction) { (void)fraction; }

  /// True as soon as the result is no longer wanted; polled at least every few milliseconds.
  [[nodiscard]] virtual bool stop_requested() const { return false; }

  /// How many closures can run at once (a hint for cutting the work; never changes a result).
  [[nodiscard]] virtual int concurrency() const { return 1; }
};

class SerialTaskRunner final : public TaskRunner {
 public:
  void run(std::span<const std::function<void()>> tasks) override {
    for (const auto& task : tasks) task();
  }
};

}  // namespace raykiln::render
