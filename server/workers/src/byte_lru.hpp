// A map bounded by bytes: the least recently used goes first.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace raykiln::server {

/// Not safe for several threads. What is inserted last stays, with what it was inserted beside, even if
/// they alone are over the bound.
template <class Value>
class ByteLru {
 public:
  explicit ByteLru(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}

  /// `beside`: an entry that this one refers to and that is not to go before it; "" for none.
  void insert(const std::string& key, Value value, std::uint64_t bytes, const std::string& beside = "") {
    erase(key);
    entries_.insert_or_assign(key, Entry{std::move(value), bytes, ++clock_});
    bytes_ += bytes;
    (void)use(beside);
    const std::size_t stay = entries_.contains(beside) ? 2 : 1;
    while (bytes_ > max_bytes_ && entries_.size() > stay) erase(oldest());
  }

  /// The value, now the most recently used.
  [[nodiscard]] std::optional<Value> use(const std::string& key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return std::nullopt;
    found->second.stamp = ++clock_;
    return found->second.value;
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
