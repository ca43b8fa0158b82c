// A task runner with threads of its own, for tests and benchmarks.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "raykiln/accel/task_runner.hpp"

namespace raykiln::test {

/// Runs closures on up to `threads` threads in all, also when called from inside a closure.
class ThreadRunner final : public render::TaskRunner {
 public:
  explicit ThreadRunner(int threads) : threads_(threads), spare_(threads - 1) {}

  void run(std::span<const std::function<void()>> tasks) override {
    std::atomic<std::size_t> next{0};
    std::exception_ptr error;
    std::mutex error_mutex;
    const auto work = [&] {
      for (std::size_t i = next++; i < tasks.size(); i = next++) {
        try {
          tasks[i]();
        } catch (...) {
          const std::scoped_lock lock(error_mutex);
          error = std::current_exception();
        }
      }
    };
    std::vector<std::jthread> extra;
    while (extra.size() + 1 < tasks.size() && take_spare()) {
      extra.emplace_back([&] {
        work();
        ++spare_;
      });
    }
    work();
    extra.clear();  // joins
    if (error) std::rethrow_exception(error);
  }
  [[nodiscard]] int concurrency() const override { return threads_; }

 private:
  bool take_spare() {
    int spare = spare_.load();
    while (spare > 0) {
      if (spare_.compare_exchange_weak(spare, spare - 1)) return true;
    }
    return false;
  }

  int threads_;
  std::atomic<int> spare_;
};

}  // namespace raykiln::test
