#include "raykiln/api/problem.hpp"

#include <gtest/gtest.h>

#include "raykiln/api/percent.hpp"
#include "raykiln/api/scene_json.hpp"

namespace raykiln::server {
namespace {

TEST(Problem, MapsKindsToStatuses) {
  const std::pair<Error, int> rows[] = {
      {{ErrorKind::kInvalid, "scene_invalid", "m", "a.obj:1"}, 422},
      {{ErrorKind::kInvalid, "invalid_parameter", "m", "cursor"}, 400},
      {{ErrorKind::kUnsupported, "scene_unsupported", "m", {}}, 422},
      {{ErrorKind::kNotFound, "job_not_found", "m", {}}, 404},
      {{ErrorKind::kConflict, "scene_in_use", "m", {}}, 409},
      {{ErrorKind::kTooLarge, "film_too_large", "m", {}}, 422},
      {{ErrorKind::kTooLarge, "payload_too_large", "m", {}}, 413},
      {{ErrorKind::kTooMany, "queue_full", "m", {}}, 429},
      {{ErrorKind::kUnavailable, "shutting_down", "m", {}}, 503},
      {{ErrorKind::kStorageFull, "storage_full", "m", {}}, 507},
      {{ErrorKind::kInternal, "internal", "m", {}}, 500},
  };
  for (const auto& [error, status] : rows) EXPECT_EQ(problem_of(error).status, status) << error.code;
}

TEST(Problem, SaysWhenToComeBack) {
  Error busy{ErrorKind::kTooMany, "queue_full", "m", {}};
  busy.retry_after_s = 17;
  const auto response = to_response(problem_of(busy));
  EXPECT_EQ(*find_value(response.headers, "Retry-After"), "17");
  EXPECT_EQ(response.content_type, "application/problem+json");
}

TEST(Problem, ReadsAsText) {
  const Problem problem{422, "scene_invalid", "Kd needs three numbers", "a.mtl:7"};
  EXPECT_EQ(problem_text(problem_json(problem)), "scene_invalid: Kd needs three numbers (a.mtl:7)");
  EXPECT_EQ(problem_text("plain"), "plain");
}

TEST(Problem, SurvivesTextThatIsNoUtf8) {
  EXPECT_NE(problem_json({422, "unsafe_name", "bad", "\xFF\xFE"}).find("unsafe_name"), std::string::npos);
}

TEST(Percent, IsItsOwnInverse) {
  std::string all;
  for (int i = 0; i < 256; ++i) all.push_back(static_cast<char>(i));
  EXPECT_EQ(percent_decode(percent_encode(all)), all);
  EXPECT_EQ(percent_encode("a b/c"), "a%20b%2Fc");
  EXPECT_FALSE(percent_decode("%"));
  EXPECT_FALSE(percent_decode("%4"));
  EXPECT_FALSE(percent_decode("%g0"));
}

}  // namespace
}  // namespace raykiln::server
