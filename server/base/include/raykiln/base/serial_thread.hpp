// One thread with a mailbox: whatever is posted runs there, one after another.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace raykiln::server {

/// State that is touched only from closures posted here needs no lock. Closures run in the order of
/// posting; delayed ones when their time has come. An exception that escapes a closure ends the
/// process: borders are drawn inside the closures.
class SerialThread {
 public:
  explicit SerialThread(std::string name);
  ~SerialThread();  ///< stop()

  /// False (and the closure is dropped) after stop(). Safe from any thread.
  bool post(std::function<void()> closure);
  bool post_after(std::chrono::milliseconds delay, std::function<void()> closure);

  /// Runs what was posted before, drops what is delayed, joins. Once, not from the thread
  /// itself.
  void stop();

 private:
  void loop();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> ready_;
  std::multimap<std::chrono::steady_clock::time_point, std::function<void()>> delayed_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace raykiln::server
