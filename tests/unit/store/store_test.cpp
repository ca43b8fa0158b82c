#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "raykiln/base/sha256.hpp"
#include "raykiln/store/sqlite_store.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::server {
namespace {

namespace fs = std::filesystem;

struct StoreTest : testing::Test {
  tests::TempDirectory directory;
  StoreSettings settings{directory.path(), kGiB};
  UploadLimits limits;
  std::unique_ptr<Store> store;

  void open() {
    store.reset();
    auto opened = open_sqlite_store(settings, limits, Log());
    ASSERT_TRUE(opened) << opened.error().message;
    store = std::move(*opened);
  }
  void SetUp() override { open(); }

  std::unique_ptr<SceneUpload> upload(SceneKind kind,
                                      const std::vector<std::pair<std::string, std::string>>& files) {
    auto begun = store->begin_upload(kind);
    EXPECT_TRUE(begun);
    for (const auto& [name, bytes] : files) {
      EXPECT_TRUE((*begun)->begin_file(name));
      EXPECT_TRUE((*begun)->append(std::as_bytes(std::span(bytes))));
    }
    EXPECT_TRUE((*begun)->finish());
    return std::move(*begun);
  }
  bool nothing_staged() const { return fs::is_empty(directory.path() / "staging"); }
};

JobRecord job(const std::string& id, JobState state, const std::string& key = "") {
  JobRecord record;
  record.id = id;
  record.state = state;
  record.revision = 1;
  record.scene = "s";
  record.idempotency_key = key;
  record.content = "content of " + id;
  return record;
}

TEST_F(StoreTest, KeepsScenesOverARestart) {
  const std::string id = sha256_hex("bytes");
  ASSERT_TRUE(*store->commit_scene(upload(SceneKind::kGlb, {{"a.glb", "bytes"}}), "n", {}, "r"));
  EXPECT_FALSE(*store->commit_scene(upload(SceneKind::kGlb, {{"a.glb", "bytes"}}), "m", {}, "q"));
  EXPECT_TRUE(nothing_staged());
  open();
  const auto scene = store->scene(id);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->name, "n");
  EXPECT_EQ(scene->report, "r");
  EXPECT_EQ(store->bytes_used(), 5U);
  const auto files = store->scene_files(id);
  std::ifstream in(files->at(0).path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "bytes");
  EXPECT_TRUE(store->delete_scene(id));
  EXPECT_EQ(store->scene(id).error().code, "scene_not_found");
  EXPECT_EQ(store->bytes_used(), 0U);
}

TEST_F(StoreTest, IdOfFilesIsTheDigestOfTheirSortedList) {
  const auto u = upload(SceneKind::kFiles, {{"b.mtl", "xy"}, {"a.obj", "z"}});
  const std::string list = std::string("a.obj\0", 6) + "1" + '\0' + sha256_hex("z") + "\nb.mtl" +
                           '\0' + "2" + '\0' + sha256_hex("xy") + "\n";
  EXPECT_EQ(u->id(), sha256_hex(list));
}

TEST_F(StoreTest, AbortedUploadsLeaveNothing) {
  (void)upload(SceneKind::kFiles, {{"a.obj", "z"}});
  EXPECT_TRUE(nothing_staged());
  auto begun = store->begin_upload(SceneKind::kFiles);
  for (const char* name : {"../a", "/a", "a//b", ""}) {
    EXPECT_EQ((*begun)->begin_file(name).error().code, "unsafe_name");
  }
  EXPECT_TRUE((*begun)->begin_file("a"));
  EXPECT_EQ((*begun)->begin_file("a").error().code, "unsafe_name");
  auto empty = store->begin_upload(SceneKind::kFiles);
  EXPECT_EQ((*empty)->finish().error().code, "scene_empty");
  auto two = store->begin_upload(SceneKind::kZip);
  EXPECT_TRUE((*two)->begin_file("a"));
  EXPECT_EQ((*two)->begin_file("b").error().code, "payload_too_large");
}

TEST_F(StoreTest, BytesAreBounded) {
  limits.max_upload_bytes = 8;
  limits.max_staging_bytes = 12;
  open();
  const std::string six(6, 'x');
  const auto bytes = std::as_bytes(std::span(six));
  auto one = store->begin_upload(SceneKind::kZip);
  ASSERT_TRUE((*one)->begin_file("a"));
  EXPECT_TRUE((*one)->append(bytes));
  EXPECT_EQ((*one)->append(bytes).error().code, "payload_too_large");
  auto two = store->begin_upload(SceneKind::kZip);
  ASSERT_TRUE((*two)->begin_file("a"));
  EXPECT_TRUE((*two)->append(bytes));
  auto three = store->begin_upload(SceneKind::kZip);
  ASSERT_TRUE((*three)->begin_file("a"));
  EXPECT_EQ((*three)->append(bytes).error().code, "too_many_uploads");
  one->reset();
  three->reset();
  auto four = store->begin_upload(SceneKind::kZip);
  ASSERT_TRUE((*four)->begin_file("a"));
  EXPECT_TRUE((*four)->append(bytes)) << "room is given back";
  settings.max_bytes = 5;
  two->reset();
  four->reset();
  open();
  auto five = store->begin_upload(SceneKind::kZip);
  ASSERT_TRUE((*five)->begin_file("a"));
  EXPECT_EQ((*five)->append(bytes).error().code, "storage_full");
  EXPECT_EQ(store->put_image("j", {1, 1, {1, 2, 3}}).error().code, "storage_full");
}

TEST_F(StoreTest, AStartRemovesWhatAKilledProcessLeft) {
  const std::string id = sha256_hex("bytes"), torn = sha256_hex("torn");
  ASSERT_TRUE(store->commit_scene(upload(SceneKind::kGlb, {{"a.glb", "bytes"}}), "", {}, ""));
  ASSERT_TRUE(store->commit_scene(upload(SceneKind::kGlb, {{"a.glb", "torn"}}), "", {}, ""));
  store.reset();
  fs::resize_file(directory.path() / "scenes" / torn / "0", 2);
  fs::create_directories(directory.path() / "scenes" / "unknown");
  fs::create_directories(directory.path() / "staging" / "left");
  fs::create_directories(directory.path() / "scratch" / "left");
  std::ofstream(directory.path() / "images" / "nobody") << "x";
  open();
  EXPECT_TRUE(store->scene(id));
  EXPECT_FALSE(store->scene(torn));
  EXPECT_FALSE(fs::exists(directory.path() / "scenes" / torn));
  EXPECT_FALSE(fs::exists(directory.path() / "scenes" / "unknown"));
  EXPECT_FALSE(fs::exists(directory.path() / "images" / "nobody"));
  EXPECT_TRUE(nothing_staged());
  EXPECT_TRUE(fs::is_empty(directory.path() / "scratch"));
}

TEST_F(StoreTest, OnlyOneProcessHasIt) {
  const auto second = open_sqlite_store(settings, limits, Log());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, "store_locked");
}

TEST_F(StoreTest, KeepsJobsInOrderWithTheirKeys) {
  ASSERT_TRUE(store->put_job(job("a", JobState::kQueued, "key")));
  ASSERT_TRUE(store->put_job(job("b", JobState::kCompleted)));
  EXPECT_EQ(store->put_job(job("c", JobState::kQueued, "key")).error().code,
            "idempotency_key_reused");
  ASSERT_TRUE(store->put_job(job("a", JobState::kFailed, "key")));
  open();
  EXPECT_EQ((*store->job_with_key("key"))->id, "a");
  EXPECT_FALSE(store->job_with_key("")->has_value());
  EXPECT_EQ(store->job("x").error().code, "job_not_found");
  JobQuery query;
  const auto all = store->jobs(query);
  ASSERT_EQ(all->size(), 2U);
  EXPECT_EQ(all->at(0).id, "b");
  EXPECT_EQ(all->at(1).state, JobState::kFailed);
  query.before = all->at(0).sequence;
  EXPECT_EQ(store->jobs(query)->at(0).id, "a");
  query = {};
  query.states = {JobState::kCompleted, JobState::kQueued};
  EXPECT_EQ(store->jobs(query)->size(), 1U);
  query = {};
  query.scene = "other";
  EXPECT_TRUE(store->jobs(query)->empty());
}

TEST_F(StoreTest, LayersReadBackAndDamageIsNoticed) {
  ASSERT_TRUE(store->put_job(job("a", JobState::kCompleted)));
  StoredImage image{2, 1, {1, 2, 3, 4, 5, 6}, {0, 1, 2, 3, 4, 5}, {7, 8}, {0.5F, 0.25F}};
  image.layers = {{"albedo", {1, 2, 3, 4, 5, 6}}, {"depth", {3, HUGE_VALF}}};
  ASSERT_TRUE(store->put_image("a", image));
  open();
  const auto kept = store->image("a");
  ASSERT_TRUE(kept);
  ASSERT_EQ(kept->layers.size(), 2U);
  EXPECT_EQ(kept->layers[0].name, "albedo");
  EXPECT_EQ(kept->layers[0].values, image.layers[0].values);
  EXPECT_EQ(kept->layers[1].name, "depth");
  EXPECT_EQ(kept->layers[1].values, image.layers[1].values);
  EXPECT_EQ(kept->seconds, image.seconds);
  const fs::path file = directory.path() / "images" / "a";
  EXPECT_EQ(store->bytes_used(), fs::file_size(file));
  const auto whole = fs::file_size(file);
  for (const std::uintmax_t cut : {std::uintmax_t{4}, std::uintmax_t{68}, std::uintmax_t{80}}) {
    fs::resize_file(file, whole - cut);
    EXPECT_EQ(store->image("a").error().code, "internal") << cut;
  }
  StoredImage wrong = image;
  wrong.layers[1].values.push_back(1.0F);
  EXPECT_FALSE(store->put_image("a", wrong)) << "3 values for 2 pixels";
  wrong = image;
  wrong.layers[0].name = std::string(65, 'x');
  EXPECT_FALSE(store->put_image("a", wrong));
}

TEST_F(StoreTest, ImagesReadBackAndDamageIsNoticed) {
  ASSERT_TRUE(store->put_job(job("a", JobState::kCompleted)));
  EXPECT_EQ(store->image("a").error().code, "image_not_ready");
  EXPECT_EQ(store->image("../raykiln.db").error().code, "image_not_ready");
  ASSERT_TRUE(store->put_image("a", {1, 1, {1.0F, 2.0F, 3.0F}})) << "without layers";
  EXPECT_TRUE(store->image("a")->error.empty());
  EXPECT_FALSE(store->put_image("a", {1, 1, {1, 2, 3}, {1, 2}, {1}, {1}})) << "layers that do not fit";
  const StoredImage image{2, 1, {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 1e30F}, {0, 1, 2, 3, 4, 5}, {7, 8}, {0.5F, 0.25F}};
  ASSERT_TRUE(store->put_image("a", image));
  ASSERT_TRUE(store->put_image("a", image)) << "replaced";
  open();
  EXPECT_EQ(store->image("a")->rgb, image.rgb);
  EXPECT_EQ(store->image("a")->error, image.error);
  EXPECT_EQ(store->image("a")->samples, image.samples);
  EXPECT_EQ(store->image("a")->seconds, image.seconds);
  EXPECT_EQ(store->bytes_used(), fs::file_size(directory.path() / "images" / "a"));
  {
    std::fstream file(directory.path() / "images" / "a", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(50);
    file.put('x');
  }
  EXPECT_EQ(store->image("a").error().code, "internal");
  fs::resize_file(directory.path() / "images" / "a", 20);
  EXPECT_EQ(store->image("a").error().code, "internal");
}

TEST_F(StoreTest, PrunesTheOldestFinishedJobs) {
  for (const char* id : {"a", "b", "c"}) ASSERT_TRUE(store->put_job(job(id, JobState::kCompleted)));
  ASSERT_TRUE(store->put_job(job("d", JobState::kRendering)));
  ASSERT_TRUE(store->put_image("a", {1, 1, {1, 2, 3}}));
  ASSERT_TRUE(store->prune_jobs(1));
  EXPECT_FALSE(store->job("a"));
  EXPECT_FALSE(store->image("a"));
  EXPECT_TRUE(store->job("c"));
  EXPECT_TRUE(store->job("d"));
  EXPECT_EQ(store->bytes_used(), 0U);
}

}  // namespace
}  // namespace raykiln::server
