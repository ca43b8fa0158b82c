#include "raykiln/base/serial_thread.hpp"

#include <pthread.h>

#include <utility>

namespace raykiln::server {

SerialThread::SerialThread(std::string name) : thread_([this] { loop(); }) {
  // Only a name for debuggers (15 characters at most): a failure changes nothing.
  (void)pthread_setname_np(thread_.native_handle(), name.substr(0, 15).c_str());
}

SerialThread::~SerialThread() { stop(); }

bool SerialThread::post(std::function<void()> closure) {
  {
    const std::scoped_lock lock(mutex_);
    if (stopping_) return false;
    ready_.push_back(std::move(closure));
    // Under the lock: once it is released, this may be the post after which the owner ends us.
    wake_.notify_one();
  }
  return true;
}

bool SerialThread::post_after(std::chrono::milliseconds delay, std::function<void()> closure) {
  {
    const std::scoped_lock lock(mutex_);
    if (stopping_) return false;
    delayed_.emplace(std::chrono::steady_clock::now() + delay, std::move(closure));
    wake_.notify_one();
  }
  return true;
}

void SerialThread::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void SerialThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    const auto now = std::chrono::steady_clock::now();
    while (!delayed_.empty() && delayed_.begin()->first <= now) {
      ready_.push_back(std::move(delayed_.begin()->second));
      delayed_.erase(delayed_.begin());
    }
    if (!ready_.empty()) {
      // The closure dies before the lock is taken again: its captures may post.
      auto closure = std::exchange(ready_.front(), nullptr);
      ready_.pop_front();
      lock.unlock();
      closure();
      closure = nullptr;
      lock.lock();
    } else if (stopping_) {
      // Captures may post when they die: not under the lock.
      const auto dropped = std::exchange(delayed_, {});
      lock.unlock();
      return;
    } else if (delayed_.empty()) {
      wake_.wait(lock);
    } else {
      wake_.wait_until(lock, delayed_.begin()->first);
    }
  }
}

}  // namespace raykiln::server
