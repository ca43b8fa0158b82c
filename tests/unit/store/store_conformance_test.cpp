// What every Store promises, held against the one on disk and the one in memory.
#include <gtest/gtest.h>

#include <fstream>

#include "raykiln/base/sha256.hpp"
#include "raykiln/store/sqlite_store.hpp"
#include "support/memory_store.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::server {
namespace {

struct Kind {
  const char* name;
  std::unique_ptr<Store> (*open)(const StoreSettings&, const UploadLimits&);
};

const Kind kKinds[] = {
    {"Sqlite",
     [](const StoreSettings& settings, const UploadLimits& limits) {
       auto opened = open_sqlite_store(settings, limits, Log());
       return opened ? std::move(*opened) : nullptr;
     }},
    {"Memory", [](const StoreSettings& settings, const UploadLimits& limits) -> std::unique_ptr<Store> {
       return std::make_unique<tests::MemoryStore>(settings, limits);
     }}};

class StoreConformance : public testing::TestWithParam<Kind> {
 protected:
  tests::TempDirectory directory;
  StoreSettings settings{directory.path(), kGiB};
  UploadLimits limits;
  std::unique_ptr<Store> store;

  void open() {
    store.reset();
    store = GetParam().open(settings, limits);
    ASSERT_TRUE(store);
  }
  void SetUp() override { open(); }

  using Files = std::vector<std::pair<std::string, std::string>>;
  std::unique_ptr<SceneUpload> upload(SceneKind kind, const Files& files) {
    auto begun = store->begin_upload(kind);
    EXPECT_TRUE(begun);
    for (const auto& [name, bytes] : files) {
      EXPECT_TRUE((*begun)->begin_file(name));
      // In two pieces: what an upload is must not depend on how it was cut.
      const auto all = std::as_bytes(std::span(bytes));
      EXPECT_TRUE((*begun)->append(all.first(all.size() / 2)));
      EXPECT_TRUE((*begun)->append(all.subspan(all.size() / 2)));
    }
    EXPECT_TRUE((*begun)->finish());
    return std::move(*begun);
  }
  bool commit(SceneKind kind, const Files& files, const std::string& name = "") {
    const auto committed = store->commit_scene(upload(kind, files), name, WallTime{}, "report of " + name);
    EXPECT_TRUE(committed);
    return *committed;
  }
};

std::string text_of(const BlobFile& file) {
  std::ifstream in(file.path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

JobRecord job(const std::string& id, JobState state, const std::string& key = "", const std::string& scene = "s") {
  JobRecord record;
  record.id = id;
  record.state = state;
  record.revision = 1;
  record.scene = scene;
  record.idempotency_key = key;
  record.request_digest = "digest";
  record.content = "content of " + id;
  return record;
}

std::vector<std::string> ids(const Result<std::vector<JobRecord>>& jobs) {
  std::vector<std::string> list;
  EXPECT_TRUE(jobs);
  for (const auto& record : *jobs) list.push_back(record.id);
  return list;
}
using Ids = std::vector<std::string>;

TEST_P(StoreConformance, AScenesBytesComeBackUnderItsDigest) {
  const std::string id = sha256_hex("bytes");
  EXPECT_TRUE(commit(SceneKind::kGlb, {{"a.glb", "bytes"}}, "first"));
  EXPECT_FALSE(commit(SceneKind::kGlb, {{"b.glb", "bytes"}}, "second")) << "known: stays as it is";
  const auto scene = store->scene(id);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->name, "first");
  EXPECT_EQ(scene->report, "report of first");
  EXPECT_EQ(scene->bytes, 5U);
  EXPECT_EQ(scene->kind, SceneKind::kGlb);
  const auto files = store->scene_files(id);
  ASSERT_EQ(files->size(), 1U);
  EXPECT_EQ(files->at(0).name, "a.glb");
  EXPECT_EQ(text_of(files->at(0)), "bytes");
  EXPECT_EQ(store->bytes_used(), 5U);
}

TEST_P(StoreConformance, IdOfFilesIsTheDigestOfTheirSortedList) {
  const auto one = upload(SceneKind::kFiles, {{"b.mtl", "xy"}, {"a.obj", "z"}});
  const auto other = upload(SceneKind::kFiles, {{"a.obj", "z"}, {"b.mtl", "xy"}});
  const std::string list = std::string("a.obj\0", 6) + "1" + '\0' + sha256_hex("z") + "\nb.mtl" + '\0' +
                           "2" + '\0' + sha256_hex("xy") + "\n";
  EXPECT_EQ(one->id(), sha256_hex(list));
  EXPECT_EQ(other->id(), one->id());
  EXPECT_EQ(text_of(one->files().at(0)), "xy") << "readable before it is a scene";
}

TEST_P(StoreConformance, ScenesAreListedNewestFirstAndForgotten) {
  for (const char* bytes : {"1", "22", "333"}) commit(SceneKind::kZip, {{"a.zip", bytes}}, bytes);
  const auto page = store->scenes(1, 5);
  ASSERT_EQ(page->size(), 2U);
  EXPECT_EQ(page->at(0).name, "22");
  EXPECT_EQ(page->at(1).name, "1");
  EXPECT_EQ(store->scenes(0, 1)->at(0).name, "333");
  EXPECT_TRUE(store->delete_scene(sha256_hex("22")));
  EXPECT_EQ(store->delete_scene(sha256_hex("22")).error().code, "scene_not_found");
  EXPECT_EQ(store->scene(sha256_hex("22")).error().code, "scene_not_found");
  EXPECT_EQ(store->scene_files(sha256_hex("22")).error().code, "scene_not_found");
  EXPECT_EQ(store->bytes_used(), 4U);
}

TEST_P(StoreConformance, RefusesNamesAndShapesThatCannotBe) {
  auto begun = store->begin_upload(SceneKind::kFiles);
  for (const char* name : {"../a", "/a", "a//b", "", "a\\b"}) {
    EXPECT_EQ((*begun)->begin_file(name).error().code, "unsafe_name") << name;
  }
  EXPECT_TRUE((*begun)->begin_file("a"));
  EXPECT_EQ((*begun)->begin_file("a").error().code, "unsafe_name");
  EXPECT_EQ((*store->begin_upload(SceneKind::kFiles))->finish().error().code, "scene_empty");
  auto zip = store->begin_upload(SceneKind::kZip);
  EXPECT_TRUE((*zip)->begin_file("a"));
  EXPECT_EQ((*zip)->begin_file("b").error().code, "payload_too_large");
}

TEST_P(StoreConformance, BytesAreBoundedAndGivenBack) {
  limits.max_upload_bytes = 8;
  limits.max_staging_bytes = 12;
  open();
  const std::string six(6, 'x');
  const auto bytes = std::as_bytes(std::span(six));
  const auto begin = [&] {
    auto begun = store->begin_upload(SceneKind::kZip);
    EXPECT_TRUE((*begun)->begin_file("a"));
    return std::move(*begun);
  };
  auto one = begin(), two = begin(), three = begin();
  EXPECT_TRUE(one->append(bytes));
  EXPECT_EQ(one->append(bytes).error().code, "payload_too_large");
  EXPECT_TRUE(two->append(bytes));
  EXPECT_EQ(three->append(bytes).error().code, "too_many_uploads");
  one.reset();
  three.reset();
  EXPECT_TRUE(begin()->append(bytes)) << "room is given back";
  two.reset();
  settings.max_bytes = 5;
  open();
  EXPECT_EQ(begin()->append(bytes).error().code, "storage_full");
  EXPECT_EQ(store->put_image("j", {1, 1, {1, 2, 3}}).error().code, "storage_full");
}

TEST_P(StoreConformance, JobsKeepTheirOrderAndTheirKeys) {
  ASSERT_TRUE(store->put_job(job("a", JobState::kQueued, "key")));
  ASSERT_TRUE(store->put_job(job("b", JobState::kCompleted, "", "other")));
  ASSERT_TRUE(store->put_job(job("c", JobState::kRendering)));
  EXPECT_EQ(store->put_job(job("d", JobState::kQueued, "key")).error().code, "idempotency_key_reused");
  EXPECT_EQ(store->job("d").error().code, "job_not_found");
  ASSERT_TRUE(store->put_job(job("a", JobState::kFailed, "key"))) << "replaced, in its old place";
  EXPECT_EQ((*store->job_with_key("key"))->id, "a");
  EXPECT_EQ((*store->job_with_key("key"))->request_digest, "digest");
  EXPECT_FALSE(store->job_with_key("")->has_value());
  EXPECT_FALSE(store->job_with_key("none")->has_value());
  EXPECT_EQ(store->job("a")->state, JobState::kFailed);
  EXPECT_EQ(store->job("b")->content, "content of b");
  JobQuery query;
  EXPECT_EQ(ids(store->jobs(query)), (Ids{"c", "b", "a"}));
  query.limit = 1;
  EXPECT_EQ(ids(store->jobs(query)), (Ids{"c"}));
  query = {};
  query.before = store->job("c")->sequence;
  EXPECT_EQ(ids(store->jobs(query)), (Ids{"b", "a"}));
  query = {};
  query.states = {JobState::kCompleted, JobState::kFailed};
  EXPECT_EQ(ids(store->jobs(query)), (Ids{"b", "a"}));
  query.scene = "other";
  EXPECT_EQ(ids(store->jobs(query)), (Ids{"b"}));
}

TEST_P(StoreConformance, TheNewestCompletedJobIsFoundByItsResult) {
  const auto put = [this](const char* id, JobState state, const char* result) {
    JobRecord record = job(id, state);
    record.result_digest = result;
    ASSERT_TRUE(store->put_job(record));
  };
  put("a", JobState::kCompleted, "r");
  put("b", JobState::kCompleted, "r");
  put("c", JobState::kFailed, "r");
  put("d", JobState::kRendering, "q");
  put("e", JobState::kCompleted, "");
  EXPECT_EQ((*store->job_with_result("r"))->id, "b");
  EXPECT_EQ((*store->job_with_result("r"))->result_digest, "r");
  EXPECT_FALSE(store->job_with_result("q")->has_value());
  EXPECT_FALSE(store->job_with_result("")->has_value());
  put("d", JobState::kCompleted, "r");
  EXPECT_EQ((*store->job_with_result("r"))->id, "d") << "what it is of may be learned anew";
  ASSERT_TRUE(store->prune_jobs(0));
  EXPECT_FALSE(store->job_with_result("r")->has_value());
}

TEST_P(StoreConformance, PicturesAreReplacedAndGoWithTheirJobs) {
  for (const char* id : {"a", "b", "c"}) ASSERT_TRUE(store->put_job(job(id, JobState::kCompleted)));
  ASSERT_TRUE(store->put_job(job("d", JobState::kRendering)));
  EXPECT_EQ(store->image("a").error().code, "image_not_ready");
  ASSERT_TRUE(store->put_image("a", {2, 1, {1, 2, 3, 4, 5, 1e30F}}));
  const auto used = store->bytes_used();
  ASSERT_TRUE(store->put_image("a", {2, 1, {6, 5, 4, 3, 2, 1}}));
  EXPECT_EQ(store->bytes_used(), used);
  EXPECT_EQ(store->image("a")->rgb, (std::vector<float>{6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(store->image("a")->width, 2);
  ASSERT_TRUE(store->prune_jobs(1));
  EXPECT_FALSE(store->job("a"));
  EXPECT_FALSE(store->image("a"));
  EXPECT_TRUE(store->job("c"));
  EXPECT_TRUE(store->job("d")) << "unfinished ones stay";
  EXPECT_EQ(store->bytes_used(), 0U);
}

TEST_P(StoreConformance, ScratchDirectoriesAreFresh) {
  const auto one = store->scratch_directory(), two = store->scratch_directory();
  ASSERT_TRUE(one && two);
  EXPECT_NE(*one, *two);
  EXPECT_TRUE(std::filesystem::is_empty(*one));
}

INSTANTIATE_TEST_SUITE_P(Stores, StoreConformance, testing::ValuesIn(kKinds),
                         [](const auto& about) { return about.param.name; });

}  // namespace
}  // namespace raykiln::server
