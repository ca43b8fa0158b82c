// What every hard case shares: how many trials, and one line of a report for what was measured.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "support/sanitized.hpp"

namespace raykiln::hard {

/// True in the long run (tests/run --full).
inline bool long_run() {
  const char* value = std::getenv("RAYKILN_LONG");
  return value != nullptr && std::string_view(value) == "1";
}

/// Trials of a "never" claim: `commit` as a rule, `full` in the long run. 0 events in n trials
/// bound the rate by 3/n at 95 %. Under a sanitizer a sixteenth of many.
inline std::uint64_t trials(std::uint64_t commit, std::uint64_t full) {
  constexpr std::uint64_t kFew = 1000;
  if (tests::kSanitized) return commit <= kFew ? commit : std::max(kFew, commit / 16);
  return long_run() ? full : commit;
}

/// Samples of a statistic, as many in the long run; fewer under a sanitizer.
inline std::uint64_t all_trials(std::uint64_t n) { return trials(n, n); }

/// Samples of each pixel of a picture; a quarter under a sanitizer.
inline std::uint64_t of_a_pixel(std::uint64_t n) { return tests::kSanitized ? (n + 3) / 4 : n; }

/// Processor seconds of this process: what the others on a machine do not disturb much.
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A number as the table shows it.
inline std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}
inline std::string shown(std::uint64_t value) { return std::to_string(value); }

/// One row of the table: made at the beginning of a test, written when the test ends. Appended as
/// one line of JSON to the file that RAYKILN_HARD_REPORT names; printed if there is none.
class Row {
 public:
  /// `id` is the entry ("K01"); `mode` names the light model where it matters, else "any".
  Row(std::string id, std::string input, std::string promise, std::string mode = "any")
      : id_(std::move(id)),
        input_(std::move(input)),
        promise_(std::move(promise)),
        mode_(std::move(mode)),
        start_(cpu_seconds()) {}
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;

  /// Adds "what value" to the measured figures. Values: numbers or text.
  void measured(std::string_view what, double value) { add(what, shown(value)); }
  void measured(std::string_view what, std::uint64_t value) { add(what, shown(value)); }
  void measured(std::string_view what, std::string_view value) { add(what, value); }
  /// The promise is known not to be kept: the table says so, and the test holds today's figure.
  void falls_short() { short_ = true; }
  /// "what events of n".
  void never(std::string_view what, std::uint64_t events, std::uint64_t n) {
    add(what, shown(events) + " of " + shown(n));
  }

  ~Row() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    const bool failed = ::testing::Test::HasFailure();
    const double seconds = cpu_seconds() - start_;
    std::string line = "{\"id\":" + quoted(id_) + ",\"test\":" +
                       quoted(test == nullptr ? "" : std::string(test->test_suite_name()) + "." +
                                                         test->name()) +
                       ",\"input\":" + quoted(input_) + ",\"promise\":" + quoted(promise_) +
                       ",\"measured\":" + quoted(measured_) + ",\"seconds\":" + shown(seconds) +
                       ",\"mode\":" + quoted(mode_) + ",\"long\":" +
                       (long_run() ? "true" : "false") + ",\"passed\":" +
                       (failed ? "false" : "true") + ",\"falls_short\":" +
                       (short_ ? "true" : "false") + "}\n";
    append(line);
  }

 private:
  void add(std::string_view what, std::string_view value) {
    if (!measured_.empty()) measured_ += "; ";
    measured_.append(what).append(" ").append(value);
  }

  static std::string quoted(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') result += '\\';
      if (static_cast<unsigned char>(c) < 0x20) {
        result += ' ';
      } else {
        result += c;
      }
    }
    return result + '"';
  }

  // One write of one line: rows of tests that run side by side do not mix.
  static void append(const std::string& line) {
    const char* path = std::getenv("RAYKILN_HARD_REPORT");
    if (path == nullptr) {
      std::fputs(line.c_str(), stdout);
      return;
    }
    const int file = ::open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    const bool written =
        file >= 0 && ::write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size());
    if (file >= 0) ::close(file);
    EXPECT_TRUE(written) << "cannot append to " << path;
  }

  std::string id_, input_, promise_, mode_, measured_;
  double start_;
  bool short_ = false;
};

}  // namespace raykiln::hard
