#include <chrono>
#include <cstdio>
#include <iostream>

#include "json_text.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/selftest/selftest.hpp"

namespace raykiln::server {
namespace {

using render::selftest::Check;
using render::selftest::Outcome;

std::string in_seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", seconds);
  return text;
}

void print_row(const Check& check, const Outcome& outcome, double seconds) {
  std::cout << check.id << (outcome.passed ? "  pass  " : "  FAIL  ") << in_seconds(seconds) << " s  "
            << check.input << " (" << check.promise << "): " << outcome.measured << std::endl;
}

std::string json_row(const Check& check, const Outcome& outcome, double seconds) {
  return "{\"id\":" + json_string(check.id) + ",\"input\":" + json_string(check.input) +
         ",\"promise\":" + json_string(check.promise) + ",\"measured\":" +
         json_string(outcome.measured) + ",\"passed\":" + (outcome.passed ? "true" : "false") +
         ",\"seconds\":" + in_seconds(seconds) + "}";
}

}  // namespace

ExitCode selftest_command(const CliOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto begun = Clock::now();
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const auto checks = render::selftest::all_checks();
  std::size_t failed = 0;
  std::string rows;
  for (const Check& check : checks) {
    const auto start = Clock::now();
    const Outcome outcome = check.run();
    failed += outcome.passed ? 0 : 1;
    if (options.json) {
      if (!rows.empty()) rows += ',';
      rows += json_row(check, outcome, since(start));
    } else {
      print_row(check, outcome, since(start));
    }
  }
  if (options.json) {
    std::cout << "{\"version\":" << json_string(RAYKILN_VERSION) << ",\"checks\":" << checks.size()
              << ",\"failed\":" << failed << ",\"seconds\":" << in_seconds(since(begun))
              << ",\"rows\":[" << rows << "]}\n";
  } else {
    std::cout << checks.size() << " checks, " << failed << " failed, " << in_seconds(since(begun))
              << " s\n";
  }
  return failed == 0 ? ExitCode::kOk : ExitCode::kCheckFailed;
}

}  // namespace raykiln::server
