#include "raykiln/app/progress.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace raykiln::server {
namespace {

ProgressState rendering(double fraction) {
  ProgressState state;
  state.stage = "rendering";
  state.fraction = fraction;
  state.samples_done = 64 * fraction;
  state.samples_target = 64;
  state.elapsed_seconds = 3.14;
  state.remaining_seconds = 4.2;
  state.rays_per_second = 2.1e6;
  return state;
}

TEST(Progress, IsReadable) {
  EXPECT_EQ(progress_text(rendering(0.5), 10),
            "rendering [#####.....]  50 %  32/64 samples  3.1 s, 4.2 s left  2.10 Mrays/s");
  ProgressState queued;
  queued.stage = "queued";
  queued.elapsed_seconds = 3725;
  EXPECT_EQ(progress_text(queued, 0), "queued   0 %  1:02 h");
}

TEST(Progress, WritesATenthALineOffATerminal) {
  std::ostringstream out;
  ProgressLine line(out, false, false);
  for (int i = 0; i <= 1000; ++i) line.show(rendering(i / 1000.0));
  const auto text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 11);
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST(Progress, KeepsQuiet) {
  std::ostringstream out;
  ProgressLine(out, true, true).show(rendering(0.5));
  EXPECT_TRUE(out.str().empty());
}

}  // namespace
}  // namespace raykiln::server
