#include <exception>
#include <iostream>

#include "raykiln/app/daemon.hpp"

int main(int argc, char** argv) {
  try {
    const auto parsed = raykiln::server::parse_daemon_options(argc, argv);
    if (parsed.exit_code >= 0) return parsed.exit_code;
    return raykiln::server::run_daemon(parsed.options);
  } catch (const std::exception& error) {
    std::cerr << "raykilnd: " << error.what() << '\n';
    return 1;
  }
}
