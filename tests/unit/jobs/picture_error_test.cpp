#include <gtest/gtest.h>

#include "raykiln/jobs/job_snapshot.hpp"
#include "raykiln/jobs/picture_error.hpp"

namespace raykiln::server {
namespace {

PictureError measured(double high, std::uint64_t samples = 64) {
  PictureError error;
  error.grade = "measured";
  error.error = {0.9 * high, 0.8 * high, high};
  error.least_samples = samples;
  return error;
}

TEST(PictureError, TheUpperEndDecidesAndNotBelowTheFloor) {
  StopRule rule;
  EXPECT_FALSE(target_met(rule, measured(0.0))) << "no target";
  rule.error = 0.02;
  EXPECT_TRUE(target_met(rule, measured(0.02)));
  EXPECT_FALSE(target_met(rule, measured(0.0201)));
  EXPECT_FALSE(target_met(rule, measured(0.01, 63)));
  PictureError rough = measured(0.01);
  rough.grade = "rough";
  EXPECT_FALSE(target_met(rule, rough));
  EXPECT_FALSE(target_met(rule, PictureError{})) << "unknown is not 0";
}

TEST(PictureError, DecisionsComeAtTheFloorAndThenInTwentieths) {
  EXPECT_EQ(next_decision(0), 64U);
  EXPECT_EQ(next_decision(64), 68U);
  EXPECT_EQ(next_decision(1000), 1050U);
  EXPECT_GT(next_decision(1'048'576), 1'048'576U);
}

TEST(PictureError, ProgressNeverReachesOneByItself) {
  StopRule rule;
  rule.error = 0.01;
  EXPECT_DOUBLE_EQ(target_fraction(rule, measured(0.02)), 0.25);
  EXPECT_DOUBLE_EQ(target_fraction(rule, measured(0.005)), 0.99);
  EXPECT_DOUBLE_EQ(target_fraction(rule, PictureError{}), 0.0);
}

TEST(PictureError, TheCurveIsBoundedAndKeepsItsEnds) {
  std::vector<CurvePoint> curve;
  for (int i = 0; i < 5000; ++i) {
    CurvePoint point;
    point.render_seconds = i;
    add_point(curve, point);
  }
  EXPECT_LE(curve.size(), kMostCurvePoints);
  EXPECT_GE(curve.size(), kMostCurvePoints / 2);
  EXPECT_EQ(curve.back().render_seconds, 4999.0);
  for (std::size_t i = 1; i < curve.size(); ++i) {
    EXPECT_GT(curve[i].render_seconds, curve[i - 1].render_seconds);
  }
}

TEST(PictureError, SurvivesItsRecord) {
  JobSnapshot job;
  job.id = "j";
  job.request.stop = {.samples = 100, .seconds = 2.5, .error = 0.02, .tile_samples = {4, 8, 16}};
  job.accuracy = measured(0.02);
  job.accuracy->notices = {"heavy_tailed", "no_variance"};
  job.accuracy->heavy_tailed = true;
  job.done_by = DoneBy::kSeconds;
  job.tile_samples = {1, 2, 0};
  job.curve = {{.render_seconds = 1.5, .worker_seconds = 3, .samples = 64, .rays = 12345, .error = {0.1, 0.05, 0.2}}};
  job.forecasts = {{.made_at = 1, .error = 0.1, .seconds = {4, 3, 5}}, {.made_at = 2, .error = 0.05, .seconds = {8, 6, 10}}};
  job.forecasts[0].actual = 4.5;
  const auto read = decode_job(encode_job(job));
  ASSERT_TRUE(read && read->accuracy);
  EXPECT_EQ(read->request.stop.seconds, 2.5);
  EXPECT_EQ(read->request.stop.error, 0.02);
  EXPECT_EQ(read->request.stop.tile_samples, job.request.stop.tile_samples);
  EXPECT_EQ(read->accuracy->notices, job.accuracy->notices);
  EXPECT_EQ(read->accuracy->error.high, 0.02);
  EXPECT_TRUE(read->accuracy->heavy_tailed);
  EXPECT_EQ(read->done_by, DoneBy::kSeconds);
  EXPECT_EQ(read->tile_samples, job.tile_samples);
  ASSERT_EQ(read->forecasts.size(), 2U);
  EXPECT_TRUE(read->forecasts[0].hit());
  EXPECT_FALSE(read->forecasts[1].actual);
  EXPECT_EQ(read->forecasts[1].seconds.high, 10.0);
  ASSERT_EQ(read->curve.size(), 1U);
  EXPECT_EQ(read->curve[0].rays, 12345U);
  EXPECT_EQ(read->curve[0].error.low, 0.05);
}

}  // namespace
}  // namespace raykiln::server
