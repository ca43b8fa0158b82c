// The bound on scenes and trees in memory, through the cache itself.
#include "raykiln/workers/scene_cache.hpp"

#include <gtest/gtest.h>

#include <future>

#include "raykiln/render/limited_tree.hpp"
#include "raykiln/workers/scene_tree.hpp"
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
  Result<ReadyScene> prepared(std::size_t scene, const TreeBudget& budget) {
    auto promise = std::make_shared<std::promise<Result<ReadyScene>>>();
    const auto ticket = cache->prepare(ids[scene], budget, {}, [promise](Result<ReadyScene> r) { promise->set_value(std::move(r)); });
    return promise->get_future().get();
  }
  ReadyScene hold(std::size_t scene, const TreeBudget& budget = {}) {
    auto ready = prepared(scene, budget);
    EXPECT_TRUE(ready);
    return std::move(*ready);
  }
  /// Bytes that the tree of a scene may need at least.
  [[nodiscard]] std::uint64_t least_of(std::size_t scene) const {
    return render::least_tree_bytes(tiny_scene(0.5F, 2.0F + static_cast<float>(scene)), {});
  }
  [[nodiscard]] bool ready(std::size_t scene) const { return cache->state(ids[scene], {}) == CacheState::kReady; }
  double builds() { return metrics.counter("raykiln_tree_builds_total", "").value(); }
  double imports() { return metrics.counter("raykiln_scene_imports_total", "").value(); }

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

TreeBudget budget_of(double references, std::optional<std::uint64_t> bytes = std::nullopt) {
  TreeBudget budget;
  budget.references_per_triangle = references;
  budget.max_bytes = bytes;
  return budget;
}

TEST_F(SceneCacheTest, BudgetsHaveTreesOfTheirOwnOfOneImport) {
  open(kGiB);
  const double built = builds(), read = imports();
  const TreeBudget wide = budget_of(4.0), narrow = budget_of(1.0), bounded = budget_of(4.0, 2 * least_of(0));
  const ReadyScene a = hold(0, wide), b = hold(0, narrow), c = hold(0, bounded);
  EXPECT_EQ(builds(), built + 3.0);
  EXPECT_EQ(imports(), read + 1.0);
  EXPECT_TRUE(a.scene == b.scene && a.scene == c.scene);
  EXPECT_NE(a.prepared, b.prepared);
  EXPECT_TRUE(a.tree_key != b.tree_key && a.tree_key != c.tree_key && b.tree_key != c.tree_key);
  EXPECT_EQ(hold(0, narrow).prepared, b.prepared);
  EXPECT_EQ(builds(), built + 3.0);
  EXPECT_LT(cache->bytes(), 3 * one) << "the import counts once";
  EXPECT_GT(cache->bytes(), one);
  for (const TreeBudget& budget : {wide, narrow, bounded}) EXPECT_EQ(cache->state(ids[0], budget), CacheState::kReady);
  EXPECT_EQ(cache->state(ids[0], budget_of(2.0)), CacheState::kAbsent);
  EXPECT_EQ(cache->state(ids[0], budget_of(4.0, 1 << 2)), CacheState::kAbsent) << "no beginning of another's";
  EXPECT_TRUE(ready(0));
  cache->forget(ids[0]);
  EXPECT_FALSE(ready(0));
  for (const TreeBudget& budget : {wide, narrow, bounded}) EXPECT_EQ(cache->state(ids[0], budget), CacheState::kAbsent);
  hold(0, narrow);
  EXPECT_EQ(imports(), read + 2.0) << "what was deleted is read again";
  EXPECT_EQ(builds(), built + 3.0) << "its tree is that of any such geometry";
}

/// Who counts bytes up drives nobody out: what the bytes come to is one tree, and one scene with it.
TEST_F(SceneCacheTest, BudgetsThatComeToTheSameShareTreeAndScene) {
  open(kGiB);
  const double built = builds();
  const ReadyScene usual = hold(0), one_each = hold(0, budget_of(1.0));
  const std::uint64_t held = cache->bytes(), least = least_of(0);
  for (std::uint64_t more = 0; more < 200; ++more) {
    const TreeBudget plenty = budget_of(4.0, 100 * least + more);
    EXPECT_EQ(cache->state(ids[0], plenty), CacheState::kReady) << "without having been asked for";
    EXPECT_EQ(hold(0, plenty).prepared, usual.prepared);
  }
  EXPECT_EQ(hold(0, budget_of(4.0, least)).prepared, one_each.prepared);
  EXPECT_EQ(hold(0, budget_of(1.0 + 1e-9)).prepared, one_each.prepared);
  EXPECT_EQ(builds(), built + 2.0);
  EXPECT_EQ(cache->bytes(), held);
  EXPECT_EQ(cache->state(ids[0], budget_of(4.0, least - 1)), CacheState::kAbsent);
}

TEST_F(SceneCacheTest, AStateIsThatOfTheBudgetAskedFor) {
  open(kGiB);
  hold(0, budget_of(1.0));
  EXPECT_EQ(cache->state(ids[0], budget_of(1.0)), CacheState::kReady);
  EXPECT_EQ(cache->state(ids[0], {}), CacheState::kAbsent);
  EXPECT_EQ(cache->progress(ids[0], {}).stage, PrepareStage::kNone);
  hold(0);
  EXPECT_EQ(cache->state(ids[0], {}), CacheState::kReady);
}

/// Whoever deletes a scene has no ticket of it any more, but its import or build may be under way.
TEST_F(SceneCacheTest, NothingOfADeletedSceneIsPutBack) {
  for (const bool while_building : {false, true}) {
    std::promise<void> begun, go_on;
    const auto pause = [&begun, &go_on, paused = std::make_shared<std::atomic<bool>>(false)] {
      if (paused->exchange(true)) return;
      begun.set_value();
      go_on.get_future().wait();
    };
    intake.make = [&](const BlobFile& file) {
      if (!while_building) pause();
      return tiny_scene(0.5F, 1.0F + static_cast<float>(file.bytes));
    };
    const TreeBuilder build = [&](const render::Scene& scene, const TreeBudget& budget, render::TaskRunner& runner) {
      if (while_building) pause();
      return build_tree(scene, budget, runner);
    };
    WorkerSettings settings;
    settings.preparing_threads = 1;  // what is asked for next begins when this has ended
    cache = std::make_unique<SceneCache>(settings, SceneCache::Parts{store, intake, pool, clock, metrics, Log(), build});
    auto ticket = cache->prepare(ids[0], {}, {}, [](const Result<ReadyScene>&) {});
    begun.get_future().wait();
    ticket.reset();
    cache->forget(ids[0]);
    go_on.set_value();
    hold(1);
    EXPECT_EQ(cache->state(ids[0], {}), CacheState::kAbsent) << while_building;
    EXPECT_FALSE(cache->tree_report(ids[0])) << while_building;
    const double read = imports();
    hold(0);
    EXPECT_EQ(imports(), read + 1.0) << "its import was kept, while building: " << while_building;
    cache.reset();
  }
}

TEST_F(SceneCacheTest, BudgetsAreBoundedLikeScenes) {
  open(2 * one);
  for (int i = 0; i < 40; ++i) {
    hold(static_cast<std::size_t>(i % 2), budget_of(1.0 + i));
    EXPECT_LE(cache->bytes(), 2 * one) << i;
  }
  EXPECT_EQ(cache->state(ids[1], budget_of(40.0)), CacheState::kReady);
  EXPECT_EQ(cache->state(ids[0], budget_of(1.0)), CacheState::kAbsent);
}

TEST_F(SceneCacheTest, TooFewBytesAreRefusedWithWhatIsNeeded) {
  open(kGiB);
  const double built = builds();
  const auto refused = prepared(0, budget_of(4.0, 1));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, "tree_too_large");
  EXPECT_EQ(refused.error().kind, ErrorKind::kTooLarge);
  EXPECT_EQ(refused.error().where, "/tree/max_bytes");
  const std::uint64_t least = render::least_tree_bytes(*hold(0).scene, {});
  EXPECT_NE(refused.error().message.find(std::to_string(least) + " or more"), std::string::npos)
      << refused.error().message;
  EXPECT_EQ(builds(), built + 1.0) << "of the one that was looked at here";
  EXPECT_FALSE(prepared(0, budget_of(4.0, least - 1)));
  EXPECT_LE(hold(0, budget_of(4.0, least)).tree.stats.live_bytes_peak, least);
  EXPECT_EQ(cache->state(ids[0], budget_of(4.0, 1)), CacheState::kAbsent);
}

TEST(TreeByteLimit, BoundsWhatManyReferencesMayTake) {
  const render::Scene tiny = tiny_scene(0.5F, 1.0F);
  EXPECT_EQ(tree_byte_limit(tiny, budget_of(4.0), kGiB), 0U);
  EXPECT_EQ(tree_byte_limit(tiny, budget_of(4.0, 5000), kGiB), 5000U);
  EXPECT_EQ(tree_byte_limit(tiny, budget_of(64.0), kGiB), kGiB);
  EXPECT_EQ(tree_byte_limit(tiny, budget_of(64.0), 3 * kGiB), 3 * kGiB);
  EXPECT_EQ(tree_byte_limit(tiny, budget_of(64.0, 5000), kGiB), 5000U);
  EXPECT_EQ(tree_byte_limit(tiny, budget_of(64.0, 5 * kGiB), kGiB), kGiB);
  render::Scene large = tiny;
  large.mesh.triangles.resize(2'000'000, large.mesh.triangles.at(0));
  const std::uint64_t least = render::least_tree_bytes(large, build_params({}));
  ASSERT_GT(4 * least, kGiB);
  EXPECT_EQ(tree_byte_limit(large, budget_of(64.0), kGiB), 4 * least);
  EXPECT_EQ(tree_byte_limit(large, budget_of(64.0), 5 * least), 5 * least);
  const double one = settled_budget(large, budget_of(64.0), kGiB).references_per_triangle;
  const double two = settled_budget(large, budget_of(64.0), 8 * least).references_per_triangle;
  EXPECT_TRUE(4.0 <= one && one + 3.9 < two && two < 64.0) << one << ' ' << two;
}

TEST(SettledBudget, IsWhatDecidesTheTree) {
  const render::Scene scene = tiny_scene(0.5F, 1.0F);
  const std::uint64_t least = render::least_tree_bytes(scene, {});
  const auto settled = [&](double references, std::optional<std::uint64_t> bytes = std::nullopt) {
    const TreeBudget found = settled_budget(scene, budget_of(references, bytes), kGiB);
    EXPECT_FALSE(found.max_bytes);
    return found.references_per_triangle;
  };
  EXPECT_EQ(settled(4.0), 4.0);
  EXPECT_EQ(settled(1.5), 1.5);
  EXPECT_EQ(settled(1.1), 70.0 / 64.0);
  EXPECT_EQ(settled(64.0), 64.0);
  EXPECT_EQ(settled(4.0, least), 1.0);
  EXPECT_EQ(settled(4.0, 100 * least), 4.0);
  const double between = settled(4.0, 2 * least);
  EXPECT_TRUE(1.0 < between && between < 4.0) << between;
  EXPECT_EQ(settled(4.0, 2 * least + 1), between);
  EXPECT_EQ(settled(between, 2 * least), between) << "settled again";
}

TEST_F(SceneCacheTest, ForgetGivesBytesBack) {
  hold(1);
  cache->forget(ids[0]);
  EXPECT_FALSE(ready(0));
  EXPECT_LT(cache->bytes(), 2 * one);
}

}  // namespace
}  // namespace raykiln::tests
