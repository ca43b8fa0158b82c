#include "raykiln/api/encoded_cache.hpp"

#include <algorithm>
#include <utility>

namespace raykiln::server {

EncodedCache::EncodedCache(std::size_t max_bytes, std::size_t max_entries, int max_encoders)
    : max_bytes_(max_bytes), max_entries_(max_entries), free_encoders_(max_encoders) {}

Result<SharedBytes> EncodedCache::get(const std::string& key, const Encode& encode) {
  std::unique_lock lock(mutex_);
  while (true) {
    const auto found = find(key);
    if (found != entries_.end() && found->bytes) {
      entries_.splice(entries_.begin(), entries_, found);
      return found->bytes;
    }
    if (found == entries_.end() && free_encoders_ > 0) break;
    changed_.wait(lock);
  }
  entries_.push_front({key, nullptr});
  --free_encoders_;
  lock.unlock();

  Result<std::string> encoded = Error{ErrorKind::kInternal, "internal", "encoding failed", {}};
  try {
    encoded = encode();
  } catch (const std::exception& error) {
    encoded = Error{ErrorKind::kInternal, "internal", error.what(), {}};
  }

  lock.lock();
  ++free_encoders_;
  changed_.notify_all();
  const auto mine = find(key);
  if (!encoded) {
    entries_.erase(mine);
    return encoded.error();
  }
  const auto bytes = std::make_shared<const std::string>(std::move(*encoded));
  mine->bytes = bytes;
  bytes_ += bytes->size();
  trim();
  return SharedBytes(bytes);
}

std::size_t EncodedCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

EncodedCache::Position EncodedCache::find(const std::string& key) {
  return std::find_if(entries_.begin(), entries_.end(),
                      [&](const Entry& entry) { return entry.key == key; });
}

void EncodedCache::trim() {
  auto at = entries_.end();
  while (at != entries_.begin() && (bytes_ > max_bytes_ || entries_.size() > max_entries_)) {
    --at;
    if (!at->bytes) continue;
    bytes_ -= at->bytes->size();
    at = entries_.erase(at);
  }
}

}  // namespace raykiln::server
