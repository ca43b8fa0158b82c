// What the benchmarks of the tree share: clocks, the machine, JSON.
#pragma once

#include <time.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench_scenes.hpp"

namespace raykiln::bench {

struct Seconds {
  double wall = 0.0;
  double cpu = 0.0;  ///< of all threads of the process
};

class Stopwatch {
 public:
  [[nodiscard]] Seconds elapsed() const {
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count(),
            cpu_now() - cpu_};
  }

 private:
  static double cpu_now() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_now();
};

/// One flat JSON object, in the order of insertion.
class JsonObject {
 public:
  JsonObject& add(const std::string& key, const std::string& value) {
    std::string quoted = "\"";
    for (const char c : value) {
      if (c == '"' || c == '\\') quoted += '\\';
      if (static_cast<unsigned char>(c) >= 0x20) quoted += c;
    }
    return add_raw(key, quoted + '"');
  }
  JsonObject& add(const std::string& key, double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return add_raw(key, std::isfinite(value) ? text : "null");
  }
  JsonObject& add(const std::string& key, std::uint64_t value) {
    return add_raw(key, std::to_string(value));
  }
  JsonObject& add_raw(const std::string& key, const std::string& json) {
    text_ += (text_.empty() ? "\"" : ", \"") + key + "\": " + json;
    return *this;
  }
  [[nodiscard]] std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

inline std::string json_list(const std::vector<JsonObject>& objects) {
  std::string text = "[";
  for (const JsonObject& object : objects) {
    text += (text.size() == 1 ? "\n  " : ",\n  ") + object.text();
  }
  return text + "\n]";
}

inline std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

/// What a figure depends on besides the code.
inline JsonObject conditions(std::string_view benchmark, int threads, std::uint64_t seed) {
  JsonObject object;
  object.add("benchmark", std::string(benchmark))
      .add("compiler", std::string("gcc-compatible ") + __VERSION__)
      .add("flags", std::string(RAYKILN_BENCH_FLAGS))
      .add("cpu", cpu_model())
      .add("threads", static_cast<std::uint64_t>(threads))
      .add("seed", seed)
      .add("tree_version", static_cast<std::uint64_t>(render::kKdTreeVersion));
  return object;
}

inline bool write_file(const std::string& path, const std::string& text) {
  std::ofstream out(path);
  out << text << '\n';
  return out.good();
}

}  // namespace raykiln::bench
