// All planes of a film are the same bytes however the work was cut, run and ordered.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <thread>

#include "raykiln/accel/kernels.hpp"
#include "support/scene_pieces.hpp"

namespace raykiln::render {
namespace {

struct Cut {
  int threads = 1;
  int tile = 16;
  std::size_t blocks_a_task = 1;
};

constexpr int kWidth = 36, kHeight = 20;

RenderSettings small_settings() {
  RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.max_depth = 6;
  settings.seed = 11;
  return settings;
}

/// What threads add to, under a lock.
struct Outcome {
  Film film{kWidth, kHeight};
  RenderStats stats;
};

/// One tile's tasks in order, cut from all the blocks of the job.
void render_one_tile(const PreparedScene& scene, const RenderSettings& settings,
                     const PixelRect& rect, std::span<const SampleBlock> blocks, const Cut& cut,
                     Outcome& outcome, std::mutex& mutex) {
  for (std::size_t first = 0; first < blocks.size(); first += cut.blocks_a_task) {
    const auto some = blocks.subspan(first, std::min(cut.blocks_a_task, blocks.size() - first));
    const TileResult result = render_tile(scene, settings, rect, some, {});
    const std::lock_guard lock(mutex);
    merge(outcome.film, result);
    add(outcome.stats, result.stats);
  }
}

void render_into(Outcome& outcome, const PreparedScene& scene, const RenderSettings& settings,
                 std::span<const SampleBlock> blocks, const Cut& cut) {
  std::vector<PixelRect> tiles;
  for (int y = 0; y < kHeight; y += cut.tile) {
    for (int x = 0; x < kWidth; x += cut.tile) {
      tiles.push_back({x, y, std::min(x + cut.tile, kWidth), std::min(y + cut.tile, kHeight)});
    }
  }
  std::mutex mutex;
  std::vector<std::jthread> threads;
  for (int t = 0; t < cut.threads; ++t) {
    threads.emplace_back([&, t] {
      // Backwards and interleaved: the order of tiles must not matter either.
      for (std::size_t i = tiles.size(); i-- > 0;) {
        if (i % static_cast<std::size_t>(cut.threads) != static_cast<std::size_t>(t)) continue;
        render_one_tile(scene, settings, tiles[i], blocks, cut, outcome, mutex);
      }
    });
  }
}

Outcome render_counted(const PreparedScene& scene, const RenderSettings& settings, std::uint64_t samples,
                       const Cut& cut) {
  Outcome outcome;
  render_into(outcome, scene, settings, blocks_for(samples), cut);
  return outcome;
}

Film render(const PreparedScene& scene, const RenderSettings& settings, std::uint64_t samples,
            const Cut& cut) {
  return render_counted(scene, settings, samples, cut).film;
}

void expect_same(const Film& a, const Film& b, const std::string& what) {
  for (const PlaneSpec& spec : film_planes()) {
    const auto x = a.plane(spec.name), y = b.plane(spec.name);
    ASSERT_EQ(x.size(), y.size());
    EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0)
        << spec.name << ", " << what;
  }
}

class SameBytes : public testing::Test {
 protected:
  std::shared_ptr<const PreparedScene> scene_ = support::mixed_room().prepare();
};

TEST_F(SameBytes, ForThreadsTilesAndTaskLengths) {
  const RenderSettings settings = small_settings();
  const Film reference = render(*scene_, settings, 21, {});
  EXPECT_GT(reference.plane("beauty")[0], 0.0);
  for (const int threads : {1, 2, 7}) {
    for (const int tile : {1, 16, 1000}) {
      if (tile == 1 && threads == 2) continue;  // covered by 1 and 7, and the slowest
      for (const std::size_t length : {std::size_t{1}, std::size_t{5}}) {
        expect_same(reference, render(*scene_, settings, 21, {threads, tile, length}),
                    std::to_string(threads) + " threads, tile " + std::to_string(tile) +
                        ", blocks a task " + std::to_string(length));
      }
    }
  }
}

TEST_F(SameBytes, SixteenAndSixteenAgainstThirtyTwo) {
  const RenderSettings settings = small_settings();
  const Film whole = render(*scene_, settings, 32, {});
  Outcome parts;
  const auto blocks = blocks_for(32);
  const auto split = std::find_if(blocks.begin(), blocks.end(),
                                  [](const SampleBlock& b) { return b.first == 16; });
  render_into(parts, *scene_, settings, std::span(blocks.begin(), split), {2, 7, 3});
  render_into(parts, *scene_, settings, std::span(split, blocks.end()), {1, 1000, 1});
  expect_same(whole, parts.film, "16 + 16");
}

TEST_F(SameBytes, AnIncompleteBlockRenderedAnewLeavesNoTrace) {
  const RenderSettings settings = small_settings();
  Outcome outcome = render_counted(*scene_, settings, 21, {});
  const std::vector<SampleBlock> again{sample_block(5)};
  render_into(outcome, *scene_, settings, again, {});
  expect_same(render(*scene_, settings, 32, {}), outcome.film, "21 extended to 32");
}

TEST_F(SameBytes, OfSobolPointsToo) {
  RenderSettings settings = small_settings();
  settings.sampler = Sampler::kSobol;
  const Film reference = render(*scene_, settings, 37, {});
  expect_same(reference, render(*scene_, settings, 37, {7, 5, 2}), "7 threads, tile 5, 2 blocks a task");
  expect_same(reference, render(*scene_, settings, 37, {2, 1000, 5}), "2 threads, one tile, 5 blocks a task");
  Outcome outcome = render_counted(*scene_, settings, 21, {});
  const std::vector<SampleBlock> again{sample_block(5)};
  render_into(outcome, *scene_, settings, again, {});
  expect_same(render(*scene_, settings, 32, {}), outcome.film, "21 extended to 32");
  const auto plain = render(*scene_, small_settings(), 37, {}).plane("beauty");
  EXPECT_NE(reference.plane("beauty"), plain);
}

TEST_F(SameBytes, ForBruteForceAndOtherTrees) {
  RenderSettings settings = small_settings();
  const Film reference = render(*scene_, settings, 8, {});
  BuildParams flat;
  flat.max_depth = 2;
  flat.leaf_width = 16;
  expect_same(reference, render(*support::mixed_room().prepare(flat), settings, 8, {}), "flat tree");
  BuildParams eager;
  eager.k_t = 0.1;
  eager.k_i = 1.0;
  expect_same(reference, render(*support::mixed_room().prepare(eager), settings, 8, {}), "deep tree");
  settings.traversal = Traversal::kBruteForce;
  expect_same(reference, render(*scene_, settings, 8, {}), "brute force");
}

/// Diffuse walls and boxes, lamps that face all ways, point lights, one of them with a range: all that is shaded
/// several vertices at once. Open to one side, so that paths end early, too.
std::shared_ptr<const PreparedScene> matte_hall() {
  support::SceneBuilder b;
  const auto white = b.material(support::diffuse_material(Rgb(0.8F, 0.7F, 0.6F)));
  const auto blue = b.material(support::diffuse_material(Rgb(0.1F, 0.3F, 0.9F), Rgb(0.0F)));
  const auto lamp = b.material(support::diffuse_material(Rgb(0.0F), {9.0F, 8.0F, 4.0F}));
  const auto dim = b.material(support::diffuse_material(Rgb(0.4F), Rgb(0.2F)));
  b.box({-1.0F, -1.0F, -1.0F}, {1.0F, 1.0F, 1.5F}, white, true);
  b.box({-0.6F, -1.0F, -0.4F}, {-0.1F, 0.1F, 0.2F}, blue);
  b.box({0.2F, -1.0F, -0.1F}, {0.5F, -0.5F, 0.3F}, lamp);
  b.box({0.6F, 0.2F, -0.7F}, {0.7F, 0.25F, -0.6F}, dim);
  b.point_light({0.4F, 0.6F, 0.1F}, Rgb(0.3F, 0.2F, 0.1F));
  b.point_light({-0.7F, 0.8F, 0.9F}, Rgb(0.2F));
  b.scene().point_lights.back().range = 1.2F;
  b.camera({0.0F, 0.0F, 1.4F}, {0.0F, -0.2F, -1.0F}, {0, 1, 0}, 1.2F);
  return b.prepare();
}

/// Mirrors and clear borders, flat ones and, on an octahedron of glass, smooth ones that often face away from the viewer.
std::shared_ptr<const PreparedScene> room_of_axes() {
  support::SceneBuilder b = support::mixed_room(kLargestExponent);
  const auto glass = b.material(support::glass_material(1.4F, kLargestExponent));
  Material half = support::glass_material(1.7F, kLargestExponent);
  half.transparent = 0.6F;
  const auto partly = b.material(half);
  TriangleMesh& mesh = b.scene().mesh;
  mesh.corner_normals.assign(mesh.triangles.size(), {kNoNormal, kNoNormal, kNoNormal});
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      Vec3f normal(0.0F);
      normal[axis] = sign;
      mesh.positions.push_back(Vec3f(-0.1F, 0.1F, 0.2F) + 0.3F * normal);
      mesh.normals.push_back(normal);
    }
  }
  const auto first_normal = static_cast<std::uint32_t>(mesh.normals.size()) - 6;
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    std::array<std::uint32_t, 3> corner{octant & 1U, 2 + (octant >> 1 & 1U), 4 + (octant >> 2)};
    const bool outwards = ((octant ^ octant >> 1 ^ octant >> 2) & 1U) != 0;
    if (!outwards) std::swap(corner[0], corner[1]);
    mesh.triangles.push_back({first + corner[0], first + corner[1], first + corner[2]});
    mesh.corner_normals.push_back({first_normal + corner[0], first_normal + corner[1], first_normal + corner[2]});
    mesh.material_ids.push_back(octant < 6 ? glass : partly);
  }
  return b.prepare();
}

/// What is to be shot or shaded several at once.
struct Lanes {
  bool camera_rays = false, mattes = false, axes = false;
};
void expect_lanes(const RenderStats& stats, const Lanes& expected) {
  EXPECT_EQ(stats.lane_camera_rays, expected.camera_rays ? stats.camera_rays : 0U);
  EXPECT_EQ(stats.lane_mattes > 0, expected.mattes);
  EXPECT_EQ(stats.lane_axes > 0, expected.axes);
}

// The kernels shade vertices on diffuse surfaces, mirrors and clear borders several at once, the scalar walk's one at a time.
TEST_F(SameBytes, ForEveryKernelAndChoiceOfEmitters) {
  struct Room {
    std::shared_ptr<const PreparedScene> scene;
    bool mattes, axes;  ///< are there vertices of this kind?
  };
  const std::vector<Room> rooms{{scene_, true, false}, {matte_hall(), true, false}, {room_of_axes(), true, true}};
  for (const auto& [scene, mattes, axes] : rooms) {
    for (const Sampler sampler : {Sampler::kRandom, Sampler::kSobol}) {
      for (const EmitterChoice choice : {EmitterChoice::kPower, EmitterChoice::kTree}) {
        RenderSettings settings = small_settings();
        settings.sampler = sampler;
        settings.emitter_choice = choice;
        settings.traversal = Traversal::kScalar;
        const Outcome reference = render_counted(*scene, settings, 8, {});
        EXPECT_GT(reference.film.plane("beauty")[0], 0.0);
        expect_lanes(reference.stats, {});
        for (const Traversal kernel : {Traversal::kAvx2, Traversal::kAvx512}) {
          settings.traversal = kernel;  // what the processor cannot run becomes the scalar one
          const Outcome other = render_counted(*scene, settings, 8, {2, 9, 1});
          expect_same(reference.film, other.film, std::string(name(kernel)));
          const bool lanes = is_available(kernel);
          expect_lanes(other.stats, {lanes, lanes && mattes, lanes && axes});
        }
      }
    }
  }
}

/// Where kernels shoot camera rays: from within the geometry, at its edge, from far off and past it; in the middle of
/// pixels and anywhere; a part of a larger picture; samples of the first and of late replicates.
TEST_F(SameBytes, ForEveryKernelWhereverPathsBegin) {
  std::vector<RenderSettings> starts(5, small_settings());
  starts[1].pixel_mode = PixelMode::kCentre;
  starts[2].crop = Crop{50, 7, 130, 90};
  Camera far, past;
  far.eye = {0.0, 0.0, 1e5};
  far.fov_y_rad = 3e-5;
  past.eye = {0.0, 1.0, 3.0};
  past.fov_y_rad = 1.5;
  starts[3].own_camera = far;
  starts[4].own_camera = past;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (const Sampler sampler : {Sampler::kRandom, Sampler::kSobol}) {
      starts[i].sampler = sampler;
      for (const std::uint64_t index : {std::uint64_t{3}, std::uint64_t{9}, std::uint64_t{1} << 33}) {
        const std::vector<SampleBlock> blocks{sample_block(index)};
        Outcome reference;
        starts[i].traversal = Traversal::kScalar;
        render_into(reference, *scene_, starts[i], blocks, {});
        EXPECT_EQ(reference.stats.lane_camera_rays, 0U);
        for (const Traversal kernel : {Traversal::kAvx2, Traversal::kAvx512}) {
          starts[i].traversal = kernel;
          Outcome other;
          render_into(other, *scene_, starts[i], blocks, {1, 7, 1});
          expect_same(reference.film, other.film, "start " + std::to_string(i) + ", " + std::string(name(kernel)));
          EXPECT_EQ(other.stats.lane_camera_rays, is_available(kernel) ? other.stats.camera_rays : 0U);
        }
      }
    }
  }
}

/// Mirrors and clear borders draw no point of an emitter that cannot be seen in them; the general loop always does.
TEST_F(SameBytes, WithMirrorsThatAskForNoEmitters) {
  support::SceneBuilder room = support::mixed_room(kLargestExponent);
  const auto scene = room.prepare();
  for (const Sampler sampler : {Sampler::kRandom, Sampler::kSobol}) {
    for (const EmitterChoice choice : {EmitterChoice::kPower, EmitterChoice::kTree}) {
      RenderSettings settings = small_settings();
      settings.sampler = sampler;
      settings.emitter_choice = choice;
      const Film lean = render(*scene, settings, 16, {});
      EXPECT_GT(lean.plane("beauty")[0], 0.0);
      settings.effects = effect_choice_of("all").value();
      expect_same(render(*scene, settings, 16, {}), lean, "all effects");
    }
  }
}

TEST_F(SameBytes, WithBranches) {
  RenderSettings settings = small_settings();
  settings.branches = 3;
  settings.max_depth = 3;
  const Film reference = render(*scene_, settings, 4, {});
  expect_same(reference, render(*scene_, settings, 4, {2, 1000, 5}), "branches, large tiles");
  expect_same(reference, render(*scene_, settings, 4, {7, 1, 1}), "branches, tiles of one pixel");
}

TEST_F(SameBytes, AnotherSeedIsAnotherPicture) {
  RenderSettings settings = small_settings();
  const auto a = render(*scene_, settings, 1, {}).plane("beauty");
  settings.seed += 1;
  EXPECT_NE(a, render(*scene_, settings, 1, {}).plane("beauty"));
}

}  // namespace
}  // namespace raykiln::render
