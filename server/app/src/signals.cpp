#include "signals.hpp"

#include <pthread.h>

#include <csignal>
#include <cstdlib>
#include <ctime>

namespace raykiln::server {
namespace {

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  return set;
}

}  // namespace

void block_stop_signals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

int wait_for_stop_signal() {
  const sigset_t set = stop_signals();
  int number = 0;
  while (sigwait(&set, &number) != 0) {
  }
  return number;
}

bool stop_signal_within(std::chrono::milliseconds time) {
  const sigset_t set = stop_signals();
  const timespec span{time.count() / 1000, time.count() % 1000 * 1'000'000};
  return sigtimedwait(&set, nullptr, &span) > 0;
}

void exit_on_second_signal(std::stop_token stop) {
  const sigset_t set = stop_signals();
  const timespec moment{0, 50'000'000};
  while (!stop.stop_requested()) {
    const int number = sigtimedwait(&set, nullptr, &moment);
    if (number > 0) std::_Exit(128 + number);
  }
}

}  // namespace raykiln::server
