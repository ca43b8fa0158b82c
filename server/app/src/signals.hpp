// SIGTERM and SIGINT as something to wait for, instead of handlers.
#pragma once

#include <chrono>
#include <stop_token>

namespace raykiln::server {

/// Blocks the two signals in this thread and all that it will start, and ignores SIGPIPE. To be
/// called before any thread exists.
void block_stop_signals();

/// Waits for one of them; its number.
[[nodiscard]] int wait_for_stop_signal();

/// Waits so long; true when one of them came.
[[nodiscard]] bool stop_signal_within(std::chrono::milliseconds time);

/// Ends the process at once (128 + signal) if another one comes before `stop` is requested.
void exit_on_second_signal(std::stop_token stop);

}  // namespace raykiln::server
