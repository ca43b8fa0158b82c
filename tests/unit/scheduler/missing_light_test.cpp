// A job tells the light that its settings cut off, with its size.
#include <gtest/gtest.h>

#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

std::vector<JobWarning> warnings_of(const std::function<void(JobRequest&)>& change) {
  const TempDirectory directory;
  ServerRig rig(directory.path(), 1);
  JobRequest request = small_job(rig.add_scene("a room")->scene.record.id);
  change(request);
  const auto submitted = rig.submit(request);
  EXPECT_TRUE(submitted) << submitted.error().message;
  return rig.wait_final(submitted->job.id).warnings;
}

TEST(MissingLight, OfAFixedDepthIsAWarningWithItsSize) {
  for (const auto& warning : warnings_of([](JobRequest&) {})) EXPECT_NE(warning.code, "truncated_paths");
  const auto warnings = warnings_of([](JobRequest& r) { r.max_depth = 0; });  // the lamp lights nothing
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].code, "truncated_paths");
  EXPECT_EQ(warnings[0].where, "/max_depth");
  EXPECT_NE(warnings[0].message.find(" % +- "), std::string::npos) << warnings[0].message;
}

}  // namespace
}  // namespace raykiln::tests
