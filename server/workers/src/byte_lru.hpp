// A map bounded by bytes: the least recently used goes first.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace raykiln::server {

/// Not safe for several threads. What is inserted last stays, with what it was inserted beside, even if
/// they alone are over the bound.
template <class Value>
class ByteLru {
 public:
  explicit ByteLru(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}

  /// `beside`: entries that this one refers to and that are not to go before it.
  void insert(const std::string& key, Value value, std::uint64_t bytes,
              std::initializer_list<std::string> beside = {}) {
    erase(key);
    entries_.insert_or_assign(key, Entry{std::move(value), bytes, ++clock_});
    bytes_ += bytes;
    std::size_t stay = 1;
    for (const std::string& other : beside) stay += use(other) ? 1U : 0U;
    while (bytes_ > max_bytes_ && entries_.size() > stay) erase(oldest());
  }

  /// The value, now the most recently used.
  [[nodiscard]] std::optional<Value> use(const std::string& key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return std::nullopt;
    found->second.stamp = ++clock_;
    return found->second.value;
  }

  /// The value where there is one, as recently used as before.
  [[nodiscard]] const Value* find(const std::string& key) const {
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second.value;
  }

  /// Keys of all entries that begin so.
  [[nodiscard]] std::vector<std::string> keys_with(const std::string& prefix) const {
    std::vector<std::string> keys;
    for (auto it = entries_.lower_bound(prefix); it != entries_.end() && it->first.starts_with(prefix); ++it) {
      keys.push_back(it->first);
    }
    return keys;
  }

  [[nodiscard]] bool contains(const std::string& key) const { return entries_.contains(key); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

  void erase(const std::string& key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return;
    bytes_ -= found->second.bytes;
    entries_.erase(found);
  }

 private:
  struct Entry {
    Value value;
    std::uint64_t bytes = 0;
    std::uint64_t stamp = 0;
  };

  [[nodiscard]] std::string oldest() const {
    auto best = entries_.begin();
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (it->second.stamp < best->second.stamp) best = it;
    }
    return best->first;
  }

  std::uint64_t max_bytes_;
  std::uint64_t bytes_ = 0;
  std::uint64_t clock_ = 0;
  std::map<std::string, Entry> entries_;
};

}  // namespace raykiln::server
