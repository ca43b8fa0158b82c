// The checks that an installed binary can run on itself: scenes with a closed-form answer and a
// sample of the hard cases. Under a minute on two processors, one thread.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "raykiln/selftest/measure.hpp"

namespace raykiln::render::selftest {

/// One row: an entry of tests/hard, by its id.
struct Check {
  std::string id;       ///< "T03"
  std::string input;    ///< what is rendered or computed
  std::string promise;  ///< what must hold
  std::function<Outcome()> run;
};

/// All checks, in the order in which they are shown. No state is shared between them.
[[nodiscard]] std::vector<Check> all_checks();

}  // namespace raykiln::render::selftest
