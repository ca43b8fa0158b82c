// What is made when it is first asked for, by whichever thread asks.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace raykiln::render {

/// As std::once_flag, for what takes so long that who asks may be told to stop meanwhile. Safe to use from any thread.
class MadeOnce {
 public:
  /// True: it has been made, by this call or an earlier one. `make()` returns false where it was stopped; whoever
  /// asks next calls it again. While another thread makes it this one waits, until `stop` is requested: false.
  template <class Make>
  [[nodiscard]] bool once(const std::stop_token& stop, const Make& make) {
    if (done()) return true;
    {
      std::unique_lock lock(mutex_);
      if (!freed_.wait(lock, stop, [this] { return !taken_; })) return false;
      if (done()) return true;
      taken_ = true;
    }
    const Turn turn(*this);
    if (!make()) return false;
    made_.store(true, std::memory_order_release);
    return true;
  }

  [[nodiscard]] bool done() const { return made_.load(std::memory_order_acquire); }

 private:
  /// Gives the turn back whatever way it ends.
  class Turn {
   public:
    explicit Turn(MadeOnce& owner) : owner_(owner) {}
    ~Turn() {
      {
        const std::scoped_lock lock(owner_.mutex_);
        owner_.taken_ = false;
      }
      owner_.freed_.notify_all();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    MadeOnce& owner_;
  };

  std::atomic<bool> made_{false};
  std::mutex mutex_;
  std::condition_variable_any freed_;
  bool taken_ = false;  ///< guarded by mutex_
};

}  // namespace raykiln::render
