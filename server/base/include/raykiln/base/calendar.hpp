#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace raykiln::server {

/// A moment in the calendar, UTC. Arithmetic alone: the C library's calendar reads the time zone under a lock
/// of the whole process and takes its words from the locale.
struct UtcTime {
  std::chrono::year_month_day date;
  std::chrono::weekday weekday;
  std::chrono::hh_mm_ss<std::chrono::seconds> time;

  explicit UtcTime(std::chrono::system_clock::time_point moment)
      : UtcTime(std::chrono::floor<std::chrono::days>(moment), std::chrono::floor<std::chrono::seconds>(moment)) {}

  /// "HH:MM:SS".
  [[nodiscard]] std::string clock() const {
    char text[16];
    std::snprintf(text, sizeof text, "%02d:%02d:%02d", static_cast<int>(time.hours().count() % 24),
                  static_cast<int>(time.minutes().count() % 60), static_cast<int>(time.seconds().count() % 60));
    return text;
  }

 private:
  UtcTime(std::chrono::sys_days day, std::chrono::sys_seconds second)
      : date(day), weekday(day), time(second - day) {}
};

}  // namespace raykiln::server
