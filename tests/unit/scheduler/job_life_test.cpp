// A job from submission to its end.
#include <gtest/gtest.h>

#include "raykiln/scheduler/render_inputs.hpp"
#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

struct Life : testing::Test {
  TempDirectory directory;
  ServerRig rig{directory.path()};
  std::string scene = rig.add_scene("a room")->scene.record.id;
};

TEST_F(Life, RunsToCompletionWithAPicture) {
  const auto job = rig.submit(small_job(scene));
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_TRUE(job->created);
  std::vector<JobSnapshot> seen;
  const auto last = rig.wait_final(job->job.id, &seen);
  EXPECT_EQ(last.state, JobState::kCompleted);
  EXPECT_EQ(last.progress.samples_done, 96U * 64U * 8U);
  EXPECT_DOUBLE_EQ(last.progress.fraction(), 1.0);
  EXPECT_EQ(last.statistics.camera_rays, 96U * 64U * 8U);
  EXPECT_EQ(last.statistics.non_finite, 0U);
  EXPECT_GT(last.statistics.worker_seconds, 0.0);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GT(seen[i].revision, seen[i - 1].revision);
  }
  const auto image = rig.image(job->job.id);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_TRUE((*image)->is_final);
  EXPECT_EQ((*image)->revision, last.image_revision);
  ASSERT_EQ((*image)->image.rgb.size(), 96U * 64U * 3U);
  double sum = 0.0;
  for (const float v : (*image)->image.rgb) sum += static_cast<double>(v);
  EXPECT_GT(sum, 0.0);
}

TEST_F(Life, AnIdempotencyKeyMakesOneJob) {
  const auto first = rig.submit(small_job(scene), "key");
  const auto again = rig.submit(small_job(scene), "key");
  ASSERT_TRUE(first && again);
  EXPECT_EQ(first->job.id, again->job.id);
  EXPECT_FALSE(again->created);
  const auto other = rig.submit(small_job(scene, 9), "key");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, "idempotency_key_reused");
  rig.wait_final(first->job.id);
  EXPECT_FALSE(rig.submit(small_job(scene), "key")->created) << "kept as long as the job";
}

TEST_F(Life, AnEqualResultIsReusedWhereThatIsAskedFor) {
  JobRequest request = small_job(scene);
  request.reuse = true;
  const auto first = rig.submit(request);
  EXPECT_FALSE(first->reused);
  rig.wait_final(first->job.id);
  request.name = "another name";
  const auto again = rig.submit(request);
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->reused);
  EXPECT_EQ(again->job.state, JobState::kCompleted);
  EXPECT_TRUE(rig.image(again->job.id));
  request.seed = 7;
  EXPECT_FALSE(rig.submit(request)->reused);
  request = small_job(scene);
  EXPECT_FALSE(rig.submit(request)->reused) << "nobody asked for it";
}

TEST_F(Life, RefusesWhatCannotBe) {
  auto bad = small_job(scene);
  bad.camera = std::string("none");
  EXPECT_EQ(rig.submit(bad).error().where, "/camera");
  bad = small_job(std::string(64, 'a'));
  EXPECT_EQ(rig.submit(bad).error().code, "scene_not_found");
  bad = small_job(scene);
  bad.width = 0;
  EXPECT_EQ(rig.submit(bad).error().where, "/width");
  bad.width = bad.height = 16'384;
  bad.tile = 64;
  EXPECT_EQ(rig.submit(bad).error().code, "film_too_large");
  bad.width = 4000;
  bad.height = 3500;
  const std::uint64_t picture = film_memory(bad);
  EXPECT_LT(picture, rig.config.scheduler.max_film_bytes);
  bad.layers = "albedo,normal,depth,object_id,material_id,emission,direct,indirect";
  EXPECT_EQ(film_memory(bad), picture + std::uint64_t{4000} * 3500 * (2 * 19 * 8 + 18 * 4)) << "sums twice, values once";
  EXPECT_EQ(rig.submit(bad).error().code, "film_too_large");
  bad = small_job(scene);
  bad.layers = "beauty";
  EXPECT_EQ(rig.wait_final(rig.submit(bad)->job.id).error->where, "/layers");
  EXPECT_EQ(rig.get("nothing").error().code, "job_not_found");
  EXPECT_EQ(rig.add_scene("other", std::string(64, '0')).error().code, "digest_mismatch");
}

TEST_F(Life, CancelKeepsThePartialPictureAndIsQuick) {
  const auto job = rig.submit(small_job(scene, 1'000'000));
  ASSERT_TRUE(job);
  const std::string id = job->job.id;
  rig.follow(id, [](const JobSnapshot& s) { return s.image_revision > 0; });
  const auto begin = std::chrono::steady_clock::now();
  const auto answer = rig.cancel(id);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->state, JobState::kCancelling);
  const auto last = rig.wait_final(id);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(last.state, JobState::kCancelled);
  RecordProperty("cancel_seconds", std::to_string(took.count()));
  EXPECT_GT(last.progress.samples_done, 0U);
  EXPECT_LT(last.progress.samples_done, last.progress.samples_target);
  EXPECT_TRUE(rig.image(id));
  EXPECT_TRUE(rig.cancel(id)) << "again: changes nothing";
  EXPECT_EQ(rig.get(id)->revision, last.revision);
}

TEST_F(Life, AFinishedJobIsNotCancelled) {
  const auto job = rig.submit(small_job(scene));
  rig.wait_final(job->job.id);
  EXPECT_EQ(rig.cancel(job->job.id).error().code, "job_finished");
}

TEST_F(Life, ASceneInUseStays) {
  const auto job = rig.submit(small_job(scene, 1'000'000));
  const auto remove = [&] {
    return answer_of<std::monostate>([&](auto r) { rig.scheduler->delete_scene(scene, r); });
  };
  EXPECT_EQ(remove().error().code, "scene_in_use");
  EXPECT_TRUE(rig.cancel(job->job.id));
  rig.wait_final(job->job.id);
  EXPECT_TRUE(remove());
  EXPECT_EQ(remove().error().code, "scene_not_found");
}

TEST_F(Life, TheQueueIsBounded) {
  ServerRig small(directory.path() / "small", 1, {}, [] {
    Config config;
    config.scheduler.max_active_jobs = 1;
    config.scheduler.max_queued_jobs = 1;
    return config;
  }());
  const auto id = small.add_scene("a room")->scene.record.id;
  const auto running = small.submit(small_job(id, 1'000'000));
  small.follow(running->job.id, [](const auto& s) { return s.state == JobState::kRendering; });
  const auto waiting = small.submit(small_job(id, 1));
  EXPECT_EQ(waiting->job.queue_position, 0U);
  const auto refused = small.submit(small_job(id, 1));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, "queue_full");
  EXPECT_TRUE(refused.error().retry_after_s.has_value());
  EXPECT_EQ(small.cancel(waiting->job.id)->state, JobState::kCancelled) << "at once";
  EXPECT_TRUE(small.cancel(running->job.id));
}

TEST_F(Life, ListsNewestFirstInPages) {
  std::vector<std::string> ids;
  for (int i = 0; i < 3; ++i) ids.push_back(rig.submit(small_job(scene, 1))->job.id);
  const auto page = [&](const std::string& cursor) {
    return answer_of<JobPage>([&](auto r) { rig.scheduler->list({{}, "", cursor, 2}, r); });
  };
  const auto first = page("");
  ASSERT_EQ(first->jobs.size(), 2U);
  EXPECT_EQ(first->jobs[0].id, ids[2]);
  const auto second = page(first->next_cursor);
  ASSERT_EQ(second->jobs.size(), 1U);
  EXPECT_EQ(second->jobs[0].id, ids[0]);
  EXPECT_TRUE(second->next_cursor.empty());
  EXPECT_EQ(page("x").error().code, "invalid_parameter");
}

}  // namespace
}  // namespace raykiln::tests
