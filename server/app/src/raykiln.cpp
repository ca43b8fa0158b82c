#include <csignal>
#include <exception>
#include <iostream>

#include "raykiln/app/cli.hpp"

int main(int argc, char** argv) {
  using namespace raykiln::server;
  try {
    std::signal(SIGPIPE, SIG_IGN);
    const auto parsed = parse_cli_options(argc, argv);
    if (parsed.exit_code >= 0) return parsed.exit_code;
    return to_int(run_cli(parsed.options));
  } catch (const std::exception& error) {
    std::cerr << "raykiln: " << error.what() << '\n';
    return to_int(ExitCode::kFailure);
  }
}
