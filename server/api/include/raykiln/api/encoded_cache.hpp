// Encoded pictures and batches: made once per revision and parameters, kept in bounded memory.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <list>
#include <mutex>
#include <string>

#include "raykiln/api/message.hpp"
#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// Single flight: of several who want the same at once, one encodes and the others wait.
/// At most `max_encoders` encode at a time. Safe to use from any thread.
class EncodedCache {
 public:
  EncodedCache(std::size_t max_bytes, std::size_t max_entries, int max_encoders);

  using Encode = std::function<Result<std::string>()>;

  /// The bytes for `key`, encoded by the caller's thread if nobody has them. A failure is not kept.
  [[nodiscard]] Result<SharedBytes> get(const std::string& key, const Encode& encode);

  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Entry {
    std::string key;
    SharedBytes bytes;  ///< null while it is being encoded
  };
  using Position = std::list<Entry>::iterator;
  [[nodiscard]] Position find(const std::string& key);
  void trim();

  const std::size_t max_bytes_;
  const std::size_t max_entries_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Entry> entries_;  ///< most recently used first
  std::size_t bytes_ = 0;
  int free_encoders_;
};

}  // namespace raykiln::server
