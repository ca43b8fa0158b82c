// One exit code per outcome, for scripts; printed by --help.
#pragma once

#include <string>

namespace raykiln::server {

enum class ExitCode : int {
  kOk = 0,
  kFailure = 1,         ///< the machine: a file cannot be written, memory, a fault of this program
  kUsage = 2,           ///< the command line is wrong
  kScene = 3,           ///< the scene, or a picture to compare, is wrong or cannot be read
  kJobFailed = 4,       ///< also: the tree does not fit the bytes that it may take
  kJobCancelled = 5,
  kNoServer = 6,        ///< the server cannot be reached, or went away
  kRefused = 7,         ///< the server refused the request
  kNotFound = 8,        ///< no such job, scene or picture
  kBusy = 9,            ///< the server cannot take more now: try later
  kCheckFailed = 10,    ///< selftest: a check failed; lint: the scene has errors
  kImageDiffers = 11,   ///< compare, batch: a render is not its reference
  kLimitReached = 12,   ///< batch: before the error target; accuracy: before the reference was exact enough
  kWaitEnded = 13,      ///< batch: the wait ended (time, Ctrl-C) before the batch, which goes on
};

[[nodiscard]] inline int to_int(ExitCode code) { return static_cast<int>(code); }

[[nodiscard]] inline std::string exit_code_table() {
  return "Exit codes:\n"
         "  0  done\n"
         "  1  failure of this machine (file cannot be written, out of memory, internal fault)\n"
         "  2  wrong command line\n"
         "  3  the scene, or a picture to compare, is wrong or cannot be read\n"
         "  4  the job failed, or its tree does not fit --tree-bytes; batch: a picture failed\n"
         "  5  the job was cancelled; batch: a picture was, or was skipped\n"
         "  6  the server cannot be reached\n"
         "  7  the server refused the request\n"
         "  8  no such job, scene or picture\n"
         "  9  the server is busy or stopping; try again later\n"
         "  10 selftest: a check failed; lint: the scene has errors\n"
         "  11 compare, batch: a render differs from its reference\n"
         "  12 batch: a limit was reached before the error target; accuracy: before the reference was exact enough\n"
         "  13 batch: the wait ended (--timeout, Ctrl-C) before the batch, which goes on\n";
}

}  // namespace raykiln::server
