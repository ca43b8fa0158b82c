// Every (pixel, block) is rendered and merged exactly once, in order, whatever workers do.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "raykiln/jobs/tile_plan.hpp"

namespace raykiln::server {
namespace {

struct Case {
  int width, height, tile;
  std::vector<std::uint32_t> blocks;
  double seconds_per_sample;
};

void run(const Case& c, unsigned seed) {
  std::mt19937 random(seed);
  TilePlan plan(c.width, c.height, c.tile, c.blocks, TaskLength{});
  std::vector<std::size_t> merged(static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height));
  std::vector<std::size_t> given(merged.size());
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(c.width) +
           static_cast<std::size_t>(x);
  };
  const auto each = [&](const WorkItem& item, auto&& visit) {
    for (const auto& part : item.parts) {
      for (int y = part.rect.y0; y < part.rect.y1; ++y) {
        for (int x = part.rect.x0; x < part.rect.x1; ++x) visit(at(x, y));
      }
    }
  };
  const std::uint64_t all = merged.size();
  std::vector<WorkItem> flying;
  std::uint64_t first_blocks = 0;
  while (!plan.done()) {
    const bool can_take = flying.size() < 5;
    auto item = can_take ? plan.next() : std::nullopt;
    if (item) {
      ASSERT_LT(item->first_block, item->end_block);
      if (item->attempt == 1) {
        each(*item, [&](std::size_t p) {
          ASSERT_EQ(given[p], item->first_block) << "in order";
          ASSERT_EQ(merged[p], given[p]) << "only one pass in flight";
          given[p] = item->end_block;
          if (item->first_block == 0) ++first_blocks;
        });
        if (item->first_block > 0) {
          ASSERT_EQ(first_blocks, all) << "the first block of all tiles comes first";
        }
      }
      flying.push_back(std::move(*item));
      continue;
    }
    ASSERT_FALSE(flying.empty()) << "stuck";
    const std::size_t i = random() % flying.size();
    const WorkItem chosen = flying[i];
    flying.erase(flying.begin() + static_cast<std::ptrdiff_t>(i));
    if (random() % 10 == 0) {
      ASSERT_TRUE(plan.failed(chosen));
      EXPECT_FALSE(plan.failed(chosen));
      EXPECT_FALSE(plan.merged(chosen, 1.0)) << "late";
      continue;
    }
    double samples = 0.0;
    each(chosen, [&](std::size_t p) {
      ASSERT_EQ(merged[p], chosen.first_block);
      merged[p] = chosen.end_block;
      for (std::size_t b = chosen.first_block; b < chosen.end_block; ++b) samples += c.blocks[b];
    });
    ASSERT_TRUE(plan.merged(chosen, samples * c.seconds_per_sample));
    EXPECT_FALSE(plan.merged(chosen, 1.0)) << "twice";
  }
  for (const std::size_t blocks : merged) ASSERT_EQ(blocks, c.blocks.size());
  EXPECT_EQ(plan.samples_done(), plan.samples_target());
  EXPECT_EQ(plan.tiles_done(), plan.tiles());
  EXPECT_EQ(plan.items_in_flight(), 0U);
  EXPECT_FALSE(plan.next());
}

TEST(TilePlanProperty, EveryPixelAndBlockOnceAndInOrder) {
  const Case cases[] = {{64, 48, 16, {1, 1, 2, 4, 8, 16, 16}, 1e-6},
                        {100, 70, 64, {1, 1, 2, 4, 8, 16, 5}, 1e-4},
                        {33, 7, 1, {1, 1, 2}, 1e-7},
                        {300, 300, 1000, {1, 1, 2, 4}, 1e-5},
                        {1, 1, 64, {1}, 1e-3},
                        {50, 50, 7, {1, 1, 2, 4, 8, 16, 16, 16, 16}, 1e-9}};
  for (const Case& c : cases) {
    for (unsigned seed = 1; seed <= 5; ++seed) run(c, seed);
  }
}

// Begun at any samples, tile by tile, the rest is handed out once and in order.
TEST(TilePlanProperty, ResumedTilesGetWhatTheyLackAndNoMore) {
  const std::vector<std::uint32_t> blocks{1, 1, 2, 4, 8, 16, 7};
  const std::vector<std::uint64_t> borders{0, 1, 2, 4, 8, 16, 32, 39};
  for (unsigned seed = 1; seed <= 50; ++seed) {
    std::mt19937 random(seed);
    TilePlan plan(40, 30, 10, blocks, TaskLength{});
    std::vector<std::uint64_t> begun(12);
    for (auto& samples : begun) samples = random() % 45;
    plan.resume(begun);
    std::vector<std::size_t> next(12);
    for (std::size_t i = 0; i < 12; ++i) {
      next[i] = static_cast<std::size_t>(std::upper_bound(borders.begin(), borders.end(), begun[i]) - borders.begin()) - 1;
    }
    EXPECT_EQ(plan.furthest_block(), *std::max_element(next.begin(), next.end()));
    while (auto item = plan.next()) {
      for (const auto& part : item->parts) {
        ASSERT_EQ(part.rect.pixels(), 100U);  // whole tiles: so little work is not cut
        std::size_t& at = next[static_cast<std::size_t>(part.rect.y0 / 10 * 4 + part.rect.x0 / 10)];
        ASSERT_EQ(item->first_block, at);
        at = item->end_block;
      }
      ASSERT_TRUE(plan.merged(*item, 1e-9));
    }
    EXPECT_TRUE(plan.done());
    EXPECT_EQ(plan.samples_done(), plan.samples_target());
    EXPECT_EQ(plan.tiles_started(), 12);
    for (const std::size_t blocks_merged : next) EXPECT_EQ(blocks_merged, blocks.size());
  }
}

TEST(TilePlanProperty, TasksSettleAtTheirLength) {
  for (const double cost : {2e-8, 1e-6, 1e-5}) {
    TilePlan plan(640, 480, 64, std::vector<std::uint32_t>(64, 16), TaskLength{});
    double late = 0.0;
    int count = 0, all = 0;
    while (auto item = plan.next()) {
      double samples = 0.0;
      for (const auto& part : item->parts) {
        samples += static_cast<double>(part.rect.pixels() * 16 * (item->end_block - item->first_block));
      }
      if (++all > 200) {
        late += samples * cost;
        ++count;
      }
      ASSERT_TRUE(plan.merged(*item, samples * cost));
    }
    if (count == 0) continue;
    const double mean = late / count;
    EXPECT_LE(mean, 0.050) << cost;
    EXPECT_GE(mean, 0.001) << cost;
    if (cost == 1e-6) {
      EXPECT_NEAR(mean, 0.025, 0.020);
    }
  }
}

TEST(TilePlanProperty, AbandonedPlansGiveAndTakeNothing) {
  TilePlan plan(64, 64, 32, {1, 1}, TaskLength{});
  const auto item = plan.next();
  plan.abandon();
  EXPECT_FALSE(plan.merged(*item, 1.0));
  EXPECT_FALSE(plan.failed(*item));
  EXPECT_FALSE(plan.next());
  EXPECT_EQ(plan.samples_done(), 0U);
}

/// Takes and merges until nothing is left to hand out.
void work_off(TilePlan& plan) {
  while (auto item = plan.next()) {
    ASSERT_TRUE(plan.merged(*item, 0.02));
  }
}

TEST(TilePlanProperty, ALimitHoldsAllTilesAtOneBorder) {
  TilePlan plan(100, 70, 32, {1, 1, 2, 4, 8, 16, 16, 16, 16}, TaskLength{});
  plan.set_limit(plan.blocks_for(5));
  for (const std::uint64_t samples : {8U, 16U, 48U}) {
    work_off(plan);
    EXPECT_TRUE(plan.at_rest());
    EXPECT_FALSE(plan.done());
    for (const std::uint64_t n : plan.tile_samples()) EXPECT_EQ(n, samples);
    plan.set_limit(plan.blocks_for(samples == 8 ? 9 : 33));
  }
  plan.set_limit(plan.blocks_for(1'000'000));
  work_off(plan);
  EXPECT_TRUE(plan.done());
}

TEST(TilePlanProperty, AClosedPlanEndsEveryTileAtABorder) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    TilePlan plan(300, 200, 64, std::vector<std::uint32_t>(50, 16), TaskLength{});
    std::vector<WorkItem> flying;
    for (unsigned step = 0; step < 40 * seed; ++step) {
      if (flying.size() < 5) {
        if (auto item = plan.next()) flying.push_back(std::move(*item));
      }
      const std::size_t i = random() % flying.size();
      ASSERT_TRUE(plan.merged(flying[i], 0.2));
      flying.erase(flying.begin() + static_cast<std::ptrdiff_t>(i));
      if (flying.empty()) flying.push_back(*plan.next());
    }
    plan.close();
    for (const WorkItem& item : flying) ASSERT_TRUE(plan.merged(item, 0.2));
    work_off(plan);
    ASSERT_TRUE(plan.at_rest());
    std::uint64_t samples = 0;
    const auto tiles = cut_tiles(300, 200, 64);
    const auto counts = plan.tile_samples();
    for (const TileRect& r : tiles) {
      const auto at = static_cast<std::size_t>(r.y0 / 64 * 5 + r.x0 / 64);
      EXPECT_EQ(counts[at] % 16, 0U);
      samples += counts[at] * r.pixels();
    }
    EXPECT_EQ(samples, plan.samples_done()) << "no pass is half merged";

    TilePlan again(300, 200, 64, std::vector<std::uint32_t>(50, 16), TaskLength{});
    again.set_tile_samples(counts);
    work_off(again);
    EXPECT_TRUE(again.done());
    EXPECT_EQ(again.tile_samples(), counts);
    EXPECT_EQ(again.samples_done(), again.samples_target());
  }
}

TEST(TilePlanProperty, TilesCoverTheFilmOnceCentreFirst) {
  const auto tiles = cut_tiles(130, 70, 32);
  std::vector<int> seen(130 * 70);
  for (const TileRect& r : tiles) {
    for (int y = r.y0; y < r.y1; ++y) {
      for (int x = r.x0; x < r.x1; ++x) ++seen[static_cast<std::size_t>(y * 130 + x)];
    }
  }
  for (const int n : seen) ASSERT_EQ(n, 1);
  EXPECT_LE(std::abs(tiles.front().x0 + tiles.front().x1 - 130), 32);
}

// Each tile stops at its own limit, goes on when that is raised, and never beyond; a lower one takes nothing back.
TEST(TilePlanProperty, TilesHaveLimitsOfTheirOwn) {
  std::mt19937 random(7);
  const std::vector<std::uint32_t> blocks(20, 16);
  TilePlan plan(70, 40, 16, blocks, TaskLength{});
  std::vector<std::uint64_t> limits(static_cast<std::size_t>(plan.tiles()), 0), reached = limits;
  for (int round = 0; round < 20; ++round) {
    for (std::uint64_t& limit : limits) limit = random() % 330;
    plan.set_tile_limits(limits);
    while (const auto item = plan.next()) ASSERT_TRUE(plan.merged(*item, 0.001));
    for (std::size_t i = 0; i < limits.size(); ++i) {
      reached[i] = std::max(reached[i], std::min<std::uint64_t>(320, limits[i] / 16 * 16));
    }
    ASSERT_EQ(plan.tile_samples(), reached) << round;
    ASSERT_TRUE(plan.at_rest());
  }
}

}  // namespace
}  // namespace raykiln::server
