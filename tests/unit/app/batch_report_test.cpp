#include <gtest/gtest.h>

#include "batch/batch_result.hpp"

namespace raykiln::server {
namespace {

BatchPlan plan_of(std::size_t pictures) {
  BatchPlan plan;
  plan.name = "a <b> & \"c\"";
  for (std::size_t i = 0; i < pictures; ++i) plan.pictures.push_back({.name = std::string("p").append(std::to_string(i)), .scene = {}, .reference = {}, .request = {}});
  return plan;
}

BatchResult result_of(const BatchPlan& plan) {
  return {.plan = plan, .pictures = std::vector<PictureResult>(plan.pictures.size()), .batch = {}, .server = {}};
}

Comparison differing() {
  Comparison c;
  c.method = ComparisonMethod::kNoise;
  c.reason = "it is brighter";
  return c;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(BatchReport, TheGravestOutcomeIsTheBatchs) {
  const BatchPlan plan = plan_of(4);
  BatchResult result = result_of(plan);
  for (auto& r : result.pictures) r.state = PictureState::kCompleted;
  EXPECT_EQ(outcome(result), ExitCode::kOk);
  result.pictures[0].limit_reached = true;
  EXPECT_EQ(outcome(result), ExitCode::kLimitReached);
  result.pictures[1].comparison = differing();
  EXPECT_EQ(outcome(result), ExitCode::kImageDiffers);
  result.pictures[2].state = PictureState::kCancelled;
  EXPECT_EQ(outcome(result), ExitCode::kJobCancelled);
  result.pictures[3].state = PictureState::kFailed;
  EXPECT_EQ(outcome(result), ExitCode::kJobFailed);
  EXPECT_EQ(summary(result), "4 pictures: 2 completed, 1 failed, 1 cancelled; 1 differs from the reference");
}

TEST(BatchReport, AMissingReferenceIsNoSuccess) {
  const BatchPlan plan = plan_of(1);
  BatchResult result = result_of(plan);
  result.pictures[0].state = PictureState::kCompleted;
  result.pictures[0].reference_missing = true;
  EXPECT_EQ(outcome(result), ExitCode::kImageDiffers);
  EXPECT_EQ(count(batch_json(result), "\"verdict\":\"no_reference\""), 1U);
}

TEST(BatchReport, AThousandLongFailuresFitIntoWhatCiTakes) {
  const BatchPlan plan = plan_of(1000);
  BatchResult result = result_of(plan);
  std::string why;
  while (why.size() < 40'000) why += "why \xC3\xA4 ";
  for (auto& r : result.pictures) {
    r.state = PictureState::kFailed;
    r.failure = why;
  }
  const std::string xml = junit_xml(result);
  EXPECT_LT(xml.size(), 30'000'000U);
  EXPECT_EQ(count(xml, "<error "), 1000U);
  EXPECT_EQ(count(xml, "\xC3\""), 0U) << "no character is cut in two";
}

TEST(BatchReport, AWaitThatEndedComesBeforeAll) {
  const BatchPlan plan = plan_of(2);
  BatchResult result = result_of(plan);
  result.pictures[0].state = PictureState::kFailed;
  result.wait_ended = true;
  EXPECT_EQ(outcome(result), ExitCode::kWaitEnded);
  EXPECT_NE(junit_xml(result).find("it had not ended when the wait did"), std::string::npos);
}

TEST(BatchReport, SaysWhatWasReusedAndLinksToTheJob) {
  const BatchPlan plan = plan_of(1);
  BatchResult result = result_of(plan);
  result.server = "http://127.0.0.1:8080";
  result.pictures[0].state = PictureState::kCompleted;
  result.pictures[0].job = "j_1";
  result.pictures[0].reused = true;
  EXPECT_EQ(summary(result), "1 pictures: 1 completed (1 reused)");
  const std::string html = batch_html(result, "nowhere");
  EXPECT_NE(html.find("completed, reused"), std::string::npos);
  EXPECT_NE(html.find("href=\"http://127.0.0.1:8080/jobs/j_1\""), std::string::npos);
  EXPECT_NE(junit_xml(result).find("result reused"), std::string::npos);
}

TEST(BatchReport, JunitCountsAndEscapes) {
  const BatchPlan plan = plan_of(3);
  BatchResult result = result_of(plan);
  result.pictures[0].state = PictureState::kFailed;
  result.pictures[0].failure = "scene_invalid: <bad> & \"worse\"";
  result.pictures[1].state = PictureState::kCompleted;
  result.pictures[1].comparison = differing();
  result.pictures[2].state = PictureState::kSkipped;
  const std::string xml = junit_xml(result);
  EXPECT_NE(xml.find("tests=\"3\" failures=\"1\" errors=\"1\" skipped=\"1\""), std::string::npos) << xml;
  EXPECT_EQ(count(xml, "<testcase"), 3U);
  EXPECT_NE(xml.find("scene_invalid: &lt;bad&gt; &amp; &quot;worse&quot;"), std::string::npos);
  EXPECT_EQ(xml.find("<b>"), std::string::npos);
}

TEST(BatchReport, GithubGetsTenAnnotationsAtMost) {
  const BatchPlan plan = plan_of(30);
  BatchResult result = result_of(plan);
  for (auto& r : result.pictures) {
    r.state = PictureState::kFailed;
    r.failure = "100% wrong\n::error::forged";
  }
  const std::string text = github_annotations(result);
  EXPECT_EQ(count(text, "\n"), 10U);
  EXPECT_NE(text.find("21 more"), std::string::npos);
  EXPECT_NE(text.find("100%25 wrong%0A::error"), std::string::npos);
}

TEST(BatchReport, TheSummaryIsAMarkdownTable) {
  const BatchPlan plan = plan_of(2);
  BatchResult result = result_of(plan);
  result.pictures[0].state = PictureState::kFailed;
  result.pictures[0].failure = "a | b";
  EXPECT_NE(step_summary(result).find("| p0 | a   b |"), std::string::npos) << step_summary(result);
}

TEST(BatchReport, HtmlHoldsNoForeignMarkup) {
  const BatchPlan plan = plan_of(1);
  BatchResult result = result_of(plan);
  result.pictures[0].state = PictureState::kFailed;
  result.pictures[0].failure = "<script>alert(1)</script>";
  const std::string html = batch_html(result, "/nowhere");
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(html.find("http"), html.find("http-equiv"));
}

}  // namespace
}  // namespace raykiln::server
