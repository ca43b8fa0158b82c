// A replayed sample is the one of the tile.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "raykiln/render/replay.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

TEST(Replay, IsTheSampleOfTheTile) {
  const auto scene = support::mixed_room().prepare();
  RenderSettings settings;
  settings.width = 12;
  settings.height = 8;
  settings.seed = 99;
  for (const std::uint64_t sample : {0ULL, 5ULL, (1ULL << 40) + 3}) {
    const SampleBlock one{.index = 0, .first = sample, .count = 1, .complete = false};
    const auto tile = render_tile(*scene, settings, {0, 0, 12, 8}, std::span(&one, 1), {});
    const auto& beauty = tile.blocks[0].planes.planes[BlockPlane::kBeauty];
    for (const auto& [x, y] : {std::pair{0, 0}, {11, 7}, {5, 3}}) {
      const ReplayedSample replayed = replay_sample(*scene, settings, x, y, sample);
      const auto at = 3 * static_cast<std::size_t>(12 * y + x);
      EXPECT_EQ(replayed.radiance, Rgbd(beauty[at], beauty[at + 1], beauty[at + 2]));
      EXPECT_FALSE(replayed.dropped);
    }
  }
}

TEST(Replay, ShowsWhatWasNotFinite) {
  support::SceneBuilder b;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  b.quad({Vec3f(-1, -1, 0), {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
         b.material(support::diffuse_material(Rgb(0.5F), {1.0F, nan, 1.0F})));
  b.camera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0.5F);
  RenderSettings settings;
  settings.width = settings.height = 2;
  settings.max_depth = 0;
  const ReplayedSample replayed = replay_sample(*b.prepare(), settings, 1, 1, 7);
  EXPECT_TRUE(replayed.dropped);
  EXPECT_TRUE(std::isnan(replayed.radiance.y));
  EXPECT_EQ(replayed.radiance.x, 1.0);
}

}  // namespace
}  // namespace raykiln::render
