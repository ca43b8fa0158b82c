// The bound on scenes and trees in memory, through the cache itself.
#include "raykiln/workers/scene_cache.hpp"

#include <gtest/gtest.h>

#include <future>

#include "support/fake_intake.hpp"
#include "support/memory_store.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::tests {
namespace {

using namespace server;

/// Scenes "a", "bb", "ccc", ... of different geometry and equal size.
class SceneCacheTest : public testing::Test {
 protected:
  SceneCacheTest() {
    intake.make = [](const BlobFile& file) { return tiny_scene(0.5F, 1.0F + static_cast<float>(file.bytes)); };
    for (int i = 1; i <= 5; ++i) ids.push_back(add(std::string(static_cast<std::size_t>(i), 'x')));
    open(kGiB);
    hold(0);
    one = cache->bytes();
  }

  void open(std::uint64_t max_bytes) {
    cache.reset();
    WorkerSettings settings;
    settings.threads = 1;
    settings.scene_cache_bytes = max_bytes;
    cache = std::make_unique<SceneCache>(settings,
                                         SceneCache::Parts{store, intake, pool, clock, metrics, Log(), {}});
  }
  std::string add(const std::string& bytes) {
    auto upload = store.begin_upload(SceneKind::kGlb);
    EXPECT_TRUE((*upload)->begin_file("scene.glb"));
    EXPECT_TRUE((*upload)->append(std::as_bytes(std::span(bytes))));
    EXPECT_TRUE((*upload)->finish());
    const std::string id = (*upload)->id();
    EXPECT_TRUE(store.commit_scene(std::move(*upload), "", WallTime{}, ""));
    return id;
  }
  ReadyScene hold(std::size_t scene) {
    auto promise = std::make_shared<std::promise<Result<ReadyScene>>>();
    const auto ticket = cache->prepare(ids[scene], {}, [promise](Result<ReadyScene> r) { promise->set_value(std::move(r)); });
    auto ready = promise->get_future().get();
    EXPECT_TRUE(ready);
    return std::move(*ready);
  }
  [[nodiscard]] bool ready(std::size_t scene) const { return cache->state(ids[scene]) == CacheState::kReady; }
  double builds() { return metrics.counter("raykiln_tree_builds_total", "").value(); }

  TempDirectory directory;
  MemoryStore store{StoreSettings{directory.path(), kGiB}, UploadLimits{}};
  FakeIntake intake;
  LocalPool pool{WorkerSettings{.threads = 1}};
  SystemClock clock;
  MetricsRegistry metrics;
  std::unique_ptr<SceneCache> cache;
  std::vector<std::string> ids;
  std::uint64_t one = 0;  ///< bytes of one scene with its tree
};

TEST_F(SceneCacheTest, TheLeastRecentlyUsedGoesFirst) {
  open(3 * one);
  for (const std::size_t i : {0U, 1U, 2U}) hold(i);
  EXPECT_EQ(cache->bytes(), 3 * one);
  hold(0);  // used again: 1 is the oldest now
  hold(3);
  EXPECT_LE(cache->bytes(), 3 * one);
  EXPECT_TRUE(ready(0) && ready(2) && ready(3));
  EXPECT_FALSE(ready(1));
  const double before = builds();
  hold(1);
  EXPECT_EQ(builds(), before + 1.0) << "built anew";
  EXPECT_FALSE(ready(2));
  EXPECT_LE(cache->bytes(), 3 * one);
}

TEST_F(SceneCacheTest, WhoHoldsASceneKeepsIt) {
  open(one);
  const ReadyScene held = hold(0);
  hold(1);
  EXPECT_FALSE(ready(0));
  render::RenderSettings small;
  small.width = small.height = 4;
  const auto tile = render::render_tile(*held.prepared, small, {0, 0, 4, 4}, render::blocks_for(1), {});
  EXPECT_EQ(tile.stats.camera_rays, 16U);
}

/// A scene that is kept counts with its tree, even if both are over the bound together: else a cache of
/// large trees would hold all of them and count none.
TEST_F(SceneCacheTest, ASceneOverTheBoundIsKeptAloneAndCounted) {
  open(one / 4);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    hold(i);
    EXPECT_TRUE(ready(i)) << "the last one stays";
    EXPECT_EQ(cache->bytes(), one);
    if (i > 0) {
      EXPECT_FALSE(ready(i - 1));
    }
  }
}

/// Also those that are made when a render first asks for them.
TEST_F(SceneCacheTest, TablesOfEmittersAreCounted) {
  intake.make = [](const BlobFile& file) {
    render::Scene scene = tiny_scene(0.5F, 1.0F + static_cast<float>(file.bytes));
    scene.materials[0].emission = render::Rgb(1.0F);  // of two more triangles
    return scene;
  };
  hold(1);
  EXPECT_GT(cache->bytes(), 2 * one);
  intake.make = [](const BlobFile& file) {
    render::Scene scene = tiny_scene(0.5F, 1.0F + static_cast<float>(file.bytes));
    scene.materials[1].emission = render::Rgb(0.0F);
    return scene;
  };
  const std::uint64_t two = cache->bytes();
  hold(2);
  EXPECT_LT(cache->bytes() - two, one);
}

TEST_F(SceneCacheTest, ForgetGivesBytesBack) {
  hold(1);
  cache->forget(ids[0]);
  EXPECT_FALSE(ready(0));
  EXPECT_LT(cache->bytes(), 2 * one);
}

}  // namespace
}  // namespace raykiln::tests
