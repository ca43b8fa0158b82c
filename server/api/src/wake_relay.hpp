// Between who publishes and a session that may not listen yet, or not any more.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace raykiln::server {

/// Holds wake-ups that come before the session listens, and cuts the tie when it has gone.
class WakeRelay {
 public:
  void wake() {
    const std::lock_guard lock(mutex_);
    if (target_) target_();
    else early_ = true;
  }
  /// `target` must only post (it is called under the relay's lock, which nothing else takes).
  void connect(std::function<void()> target) {
    const std::lock_guard lock(mutex_);
    target_ = std::move(target);
    if (std::exchange(early_, false)) target_();
  }
  void disconnect() {
    const std::lock_guard lock(mutex_);
    target_ = nullptr;
  }

 private:
  std::mutex mutex_;
  std::function<void()> target_;
  bool early_ = false;
};

}  // namespace raykiln::server
