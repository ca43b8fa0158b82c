// The time of one thing against the time of another, where other programs run on the same machine.
#pragma once

#include <algorithm>
#include <vector>

#include "hard/support/report.hpp"
#include "hard/support/rules.hpp"

namespace raykiln::hard {

/// Processor seconds of one call.
template <class Work>
double seconds_of(const Work& work) {
  const double start = cpu_seconds();
  work();
  return cpu_seconds() - start;
}

/// How much longer one piece of work takes than another, from groups of turns. What others do on a machine only
/// adds to a time, and what they do for long adds to both, so the least of many turns is the work's own. A group may
/// have its data anew: where it lies in memory makes some per cent, for as long as it lies there.
class Turns {
 public:
  /// `turns` of each; which goes first alternates, so that neither always finds the caches of the other.
  template <class A, class B>
  void group(int turns, const A& one, const B& other) {
    double a = kInfinite, b = kInfinite;
    for (int i = 0; i < turns; ++i) {
      if (i % 2 == 0) a = std::min(a, seconds_of(one));
      b = std::min(b, seconds_of(other));
      if (i % 2 != 0) a = std::min(a, seconds_of(one));
    }
    one_ = std::min(one_, a);
    other_ = std::min(other_, b);
    ratios_.push_back(b / a);
  }

  /// The other over the one: the lesser of the least times over all and of the median of the groups. A single turn
  /// of luck (of the clock, of a page) spoils the first for good, a neighbour that comes and goes the second.
  [[nodiscard]] double ratio() const {
    if (ratios_.empty()) return kInfinite;
    std::vector<double> sorted = ratios_;
    std::sort(sorted.begin(), sorted.end());
    return std::min(other_ / one_, sorted[sorted.size() / 2]);
  }

  /// Are there enough groups: `least` of them, and as many more, up to `most`, as it takes to see a ratio of at most `promised`?
  /// A promise that is kept is seen to be kept when the machine is quiet for a moment; one that is broken is not.
  [[nodiscard]] bool enough(int least, int most, double promised) const {
    const int taken = static_cast<int>(ratios_.size());
    return taken >= most || (taken >= least && ratio() <= promised);
  }

 private:
  double one_ = kInfinite, other_ = kInfinite;
  std::vector<double> ratios_;
};

}  // namespace raykiln::hard
