// Outcomes of the members of a class of scenes in one row of the table.
#pragma once

#include <string>

#include "hard/support/report.hpp"
#include "raykiln/selftest/measure.hpp"

namespace raykiln::hard {

/// Named members go into the table in full, of the others how many held.
class Family {
 public:
  explicit Family(Row& row) : row_(row) {}
  void named(const std::string& what, const render::selftest::Outcome& outcome) {
    EXPECT_TRUE(outcome.passed) << what << ": " << outcome.measured;
    row_.measured(what + ":", outcome.measured);
  }
  void member(const render::selftest::Outcome& outcome) {
    EXPECT_TRUE(outcome.passed) << "member " << members_ << ": " << outcome.measured;
    ++members_;
    held_ += outcome.passed ? 1 : 0;
  }
  ~Family() {
    if (members_ > 0) row_.measured("members that hold", shown(held_) + " of " + shown(members_));
  }
  Family(const Family&) = delete;
  Family& operator=(const Family&) = delete;

 private:
  Row& row_;
  std::uint64_t members_ = 0, held_ = 0;
};

}  // namespace raykiln::hard
