// Jobs that bound the tree of their scene: what they cost, never what they show.
#include <gtest/gtest.h>

#include <algorithm>

#include "raykiln/render/limited_tree.hpp"
#include "support/mesh_generators.hpp"
#include "support/server_rig.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

/// A heap of slivers over the floor: as many references as a budget allows.
render::Scene slivers(float albedo) {
  render::Scene scene = tiny_scene(albedo);
  const test::TestMesh heap = test::slivers(1500, 7, 0.01F);
  const auto first = static_cast<std::uint32_t>(scene.mesh.positions.size());
  for (const auto& p : heap.positions) {
    scene.mesh.positions.push_back(p);
    scene.bounds.grow(p);
  }
  for (const auto& t : heap.triangles) {
    scene.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    scene.mesh.material_ids.push_back(0);
  }
  return scene;
}

class TreeBudgets : public ::testing::Test {
 protected:
  std::unique_ptr<ServerRig> started() {
    auto rig = std::make_unique<ServerRig>(directory_.path(), 2);
    rig->intake.make = [](const BlobFile&) { return slivers(0.5F); };
    return rig;
  }
  void restart() {
    rig_.reset();
    rig_ = started();
  }
  JobRequest job(double references, std::optional<std::uint64_t> bytes = std::nullopt) const {
    JobRequest request = small_job(scene_, 8);
    request.tree.references_per_triangle = references;
    request.tree.max_bytes = bytes;
    return request;
  }
  JobSnapshot ended(const JobRequest& request) { return rig_->wait_final(rig_->submit(request)->job.id); }
  std::vector<float> picture(const JobId& id) { return (*rig_->image(id))->image.rgb; }
  static bool warned(const JobSnapshot& job) {
    return std::any_of(job.warnings.begin(), job.warnings.end(),
                       [](const JobWarning& w) { return w.code == "tree_budget_reached"; });
  }
  double counted(const char* metric) { return rig_->metrics.counter(metric, "").value(); }

  TempDirectory directory_;
  std::unique_ptr<ServerRig> rig_ = started();
  std::string scene_ = rig_->add_scene("slivers")->scene.record.id;
  std::uint64_t triangles_ = slivers(0.5F).mesh.triangles.size();
  std::uint64_t least_ = render::least_tree_bytes(slivers(0.5F), {});
};

TEST_F(TreeBudgets, ChangeTheTreeAndNoPixel) {
  const JobSnapshot usual = ended(job(TreeBudget{}.references_per_triangle));
  ASSERT_EQ(usual.state, JobState::kCompleted);
  ASSERT_TRUE(usual.statistics.tree);
  EXPECT_GT(usual.statistics.tree->references, 2 * triangles_);
  const auto expected = picture(usual.id);
  const std::pair<double, std::optional<std::uint64_t>> budgets[] = {
      {1.0, {}}, {2.0, {}}, {16.0, {}}, {4.0, least_}, {4.0, least_ + least_ / 2}};
  std::vector<std::uint64_t> references;
  for (const auto& [most, bytes] : budgets) {
    const JobSnapshot done = ended(job(most, bytes));
    ASSERT_EQ(done.state, JobState::kCompleted) << most;
    const TreeFigures& tree = done.statistics.tree.value();
    EXPECT_EQ(picture(done.id), expected) << most;
    EXPECT_LE(static_cast<double>(tree.references), most * static_cast<double>(triangles_));
    EXPECT_LE(tree.bytes, tree.peak_bytes);
    if (bytes) {
      EXPECT_LE(tree.peak_bytes, *bytes);
    }
    EXPECT_TRUE(tree.budget_reached || most > 4.0);
    EXPECT_EQ(warned(done), tree.budget_reached);
    references.push_back(tree.references);
  }
  EXPECT_EQ(references[0], triangles_);
  EXPECT_LT(references[1], usual.statistics.tree->references);
  EXPECT_GT(references[2], usual.statistics.tree->references);
  EXPECT_EQ(references[3], triangles_);
  EXPECT_EQ(counted("raykiln_tree_builds_total"), 5.0) << "the least bytes come to one reference a triangle";
  EXPECT_EQ(counted("raykiln_scene_imports_total"), 1.0) << "one scene serves them all";
  EXPECT_GT(*ended(job(3.0)).statistics.tree_build_seconds, 0.0);
  EXPECT_EQ(*ended(job(3.0)).statistics.tree_build_seconds, 0.0) << "the tree was there";
}

TEST_F(TreeBudgets, TooFewBytesFailTheJobAndNothingElse) {
  const JobSnapshot failed = ended(job(4.0, least_ - 1));
  EXPECT_EQ(failed.state, JobState::kFailed);
  ASSERT_TRUE(failed.error);
  EXPECT_EQ(failed.error->code, "tree_too_large");
  EXPECT_EQ(failed.error->where, "/tree/max_bytes");
  EXPECT_NE(failed.error->message.find(std::to_string(least_) + " or more"), std::string::npos)
      << failed.error->message;
  EXPECT_FALSE(failed.statistics.tree);
  EXPECT_EQ(counted("raykiln_tree_builds_total"), 0.0);
  const auto status = answer_of<SchedulerStatus>([&](auto reply) { rig_->scheduler->status(reply); });
  EXPECT_EQ(status->active, 0U);
  EXPECT_EQ(ended(job(4.0, least_)).state, JobState::kCompleted) << "with what the message names";
  restart();
  EXPECT_EQ(rig_->get(failed.id)->error->code, "tree_too_large");
}

TEST_F(TreeBudgets, AreKeptByRestartsAndExtensions) {
  JobRequest long_job = job(1.5, 4 * least_);
  const TreeBudget budget = long_job.tree;
  long_job.stop.samples = 50'000;
  const JobId running = rig_->submit(long_job)->job.id;
  rig_->follow(running, [](const auto& s) { return s.state == JobState::kRendering; });
  rig_->scheduler->shutdown(0ms);
  restart();
  const auto again = rig_->follow(running, [](const auto& s) { return s.state == JobState::kRendering; });
  EXPECT_EQ(again.request.tree, budget);
  EXPECT_LE(again.statistics.tree.value().references, triangles_ + triangles_ / 2);
  EXPECT_TRUE(rig_->cancel(running));

  const JobSnapshot early = ended(job(1.5, 4 * least_));
  ExtendJob extension;
  extension.job = early.id;
  extension.stop.samples = 16;
  const auto later = answer_of<SubmittedJob>([&](auto reply) { rig_->scheduler->extend(extension, reply); });
  const JobSnapshot extended = rig_->wait_final(later->job.id);
  EXPECT_EQ(extended.request.tree, budget);
  EXPECT_EQ(extended.continued_samples, 8.0);
  EXPECT_EQ(extended.statistics.tree.value().references, early.statistics.tree.value().references);
  JobRequest whole = job(4.0);
  whole.stop.samples = 16;
  EXPECT_EQ(picture(extended.id), picture(ended(whole).id));
}

/// A sample is replayed with the tree of its job, which is made again where it is gone.
TEST_F(TreeBudgets, ReplaysUseTheTreeOfTheirJob) {
  const JobSnapshot done = ended(job(2.0));
  const auto inputs = [&] {
    return answer_of<ReplayInputs>([&](auto reply) { rig_->scheduler->replay_inputs(done.id, reply); });
  };
  EXPECT_TRUE(inputs());
  restart();
  EXPECT_EQ(ended(job(4.0)).state, JobState::kCompleted);
  auto replay = inputs();
  EXPECT_FALSE(replay) << "another budget's tree is in memory, not this one";
  while (!replay && replay.error().code == "scene_not_ready") {
    std::this_thread::yield();
    replay = inputs();
  }
  ASSERT_TRUE(replay);
  EXPECT_EQ(counted("raykiln_tree_builds_total"), 2.0);
  EXPECT_EQ(counted("raykiln_scene_imports_total"), 1.0);
}

/// Another budget's tree does not make the one ready that prepare_scene() is asked for.
TEST_F(TreeBudgets, ASceneIsReadyWithTheTreeThatPreparingMakes) {
  const auto view = [&] { return *answer_of<SceneView>([&](auto reply) { rig_->scheduler->scene(scene_, reply); }); };
  const JobSnapshot narrow = ended(job(1.0));
  ASSERT_EQ(narrow.state, JobState::kCompleted);
  EXPECT_EQ(view().cache, CacheState::kAbsent);
  EXPECT_EQ(view().tree.value().stats.references, triangles_) << "of the last one";
  const auto asked = answer_of<SceneView>([&](auto reply) { rig_->scheduler->prepare_scene(scene_, reply); });
  ASSERT_TRUE(asked);
  while (view().cache == CacheState::kBuilding) std::this_thread::yield();
  EXPECT_EQ(view().cache, CacheState::kReady);
  EXPECT_GT(view().tree.value().stats.references, 2 * triangles_);
  EXPECT_EQ(*ended(job(4.0)).statistics.tree_build_seconds, 0.0) << "there already";
}

/// The job knows already that it will never have a tree: nobody waits for one.
TEST_F(TreeBudgets, AReplaySaysAtOnceWhyItsJobHasNoTree) {
  const JobSnapshot failed = ended(job(4.0, least_ - 1));
  const auto inputs = [&] {
    return answer_of<ReplayInputs>([&](auto reply) { rig_->scheduler->replay_inputs(failed.id, reply); });
  };
  for (const bool restarted : {false, true}) {
    if (restarted) restart();
    const double before = counted("raykiln_scene_imports_total");
    const auto refused = inputs();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, "tree_too_large");
    EXPECT_EQ(refused.error().kind, ErrorKind::kTooLarge);
    EXPECT_EQ(refused.error().where, "/tree/max_bytes");
    EXPECT_EQ(refused.error().message, failed.error->message);
    EXPECT_EQ(counted("raykiln_scene_imports_total"), before) << "nothing was tried again";
  }
}

/// A scene that cannot be read any more: who waits for it is told, and not asked to wait for ever.
TEST_F(TreeBudgets, AReplayIsToldWhyItsSceneCannotBePrepared) {
  const JobSnapshot done = ended(job(2.0));
  ASSERT_EQ(done.state, JobState::kCompleted);
  restart();
  const auto readable = std::exchange(rig_->intake.make, [](const BlobFile&) -> render::Scene { throw std::runtime_error("gone bad"); });
  const auto inputs = [&] {
    auto replay = answer_of<ReplayInputs>([&](auto reply) { rig_->scheduler->replay_inputs(done.id, reply); });
    for (int i = 0; i < 10'000 && !replay && replay.error().code == "scene_not_ready"; ++i) {
      std::this_thread::sleep_for(1ms);
      replay = answer_of<ReplayInputs>([&](auto reply) { rig_->scheduler->replay_inputs(done.id, reply); });
    }
    return replay;
  };
  const auto refused = inputs();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "gone bad");
  rig_->intake.make = readable;
  EXPECT_TRUE(inputs()) << "told once, then tried again";
}

}  // namespace
}  // namespace raykiln::tests
