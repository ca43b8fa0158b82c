#include "accuracy_line.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

JobSnapshot judged(DoneBy done_by, std::vector<std::string> notices) {
  JobSnapshot job;
  job.done_by = done_by;
  job.accuracy.emplace();
  job.accuracy->grade = "measured";
  job.accuracy->error = {0.019, 0.018, 0.02};
  job.accuracy->mean_samples = 121.0;
  job.accuracy->least_samples = 121;
  job.accuracy->notices = std::move(notices);
  return job;
}

TEST(AccuracyLine, SaysTheErrorAndWhatStoppedTheJob) {
  EXPECT_EQ(accuracy_line(JobSnapshot{}), "");
  EXPECT_EQ(accuracy_line(judged(DoneBy::kSamples, {})), "error 1.9 % (95 %: 1.8 % to 2 %) after 121 samples, stopped by samples");
  JobSnapshot met = judged(DoneBy::kError, {});
  met.request.stop.error = 0.02;
  EXPECT_EQ(accuracy_line(met), "error 1.9 % (95 %: 1.8 % to 2 %) after 121 samples, stopped by error");
}

TEST(AccuracyLine, AMissedTargetComesWithItsRemedy) {
  for (const auto& [by, option] : {std::pair{DoneBy::kSamples, "allow more samples (--samples)"},
                                   std::pair{DoneBy::kSeconds, "allow more time (--seconds)"}}) {
    JobSnapshot job = judged(by, {});
    job.request.stop.error = 0.01;
    EXPECT_TRUE(accuracy_line(job).ends_with(std::string("; target of 1 % not reached: ") + option)) << accuracy_line(job);
  }
}

/// No name that only a program would know.
TEST(AccuracyLine, NoticesAreWords) {
  const std::vector<std::string> names{"unsampled_pixels", "error_unknown", "error_rough", "error_sampled",
                                       "heavy_tailed", "no_variance", "aliasing_not_measured", "adaptive"};
  for (const std::string& name : names) {
    const std::string line = accuracy_line(judged(DoneBy::kSamples, {name}));
    EXPECT_EQ(line.find('_'), std::string::npos) << line;
    EXPECT_GT(line.size(), 100U) << line;
  }
  const std::string rough = accuracy_line(judged(DoneBy::kSeconds, {"error_rough"}));
  EXPECT_NE(rough.find("fewer than 64 samples in a pixel"), std::string::npos) << rough;
  EXPECT_NE(rough.find("--samples"), std::string::npos) << rough;
  EXPECT_TRUE(accuracy_line(judged(DoneBy::kSamples, {"of_tomorrow"})).ends_with("; of_tomorrow"));
}

/// A server's job reads as one that was rendered here.
TEST(AccuracyLine, IsTheSameOfAServersJob) {
  EXPECT_EQ(accuracy_line(JobView{}), "");
  const JobSnapshot job = judged(DoneBy::kSeconds, {"error_rough", "adaptive"});
  JobView view;
  view.accuracy = job.accuracy;
  view.done_by = job.done_by;
  EXPECT_EQ(accuracy_line(view), accuracy_line(job));
  JobSnapshot missed = job;
  missed.request.stop.error = view.target = 0.01;
  EXPECT_EQ(accuracy_line(view), accuracy_line(missed));
  EXPECT_NE(accuracy_line(view).find("target of 1 % not reached"), std::string::npos);
  view.target_reached = true;
  EXPECT_EQ(accuracy_line(view), accuracy_line(job));
}

}  // namespace
}  // namespace raykiln::server
