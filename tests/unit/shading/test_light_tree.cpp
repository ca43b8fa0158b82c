#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "raykiln/sampling/random.hpp"
#include "raykiln/shading/emitters.hpp"
#include "support/statistics.hpp"

namespace raykiln::render {
namespace {

double number(std::uint64_t i, std::uint64_t what) {
  return uniform(vertex_key(path_key(77, i, what), 0, 0), Dimension::kLightU);
}
Vec3f point(std::uint64_t i, std::uint64_t what, double size) {
  return Vec3f(size * (Vec3d(number(i, what), number(i, what + 1), number(i, what + 2)) - 0.5));
}

/// Flat pieces of sizes from 1e-3 to 1 and powers from 1e-3 to 1e3 in a cube of side 10. With `fronts` two of three
/// shine to one side, and most of those face alike, as ceilings full of lamps do.
std::vector<EmitterBounds> many(std::size_t count, bool fronts = false) {
  std::vector<EmitterBounds> result;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Vec3f middle = point(i, 0, 10.0);
    const Vec3f half(static_cast<float>(std::pow(10.0, -3.0 * number(i, 3))));
    const bool one_sided = fronts && i % 3 != 0;
    const Vec3f axis = one_sided && i % 9 < 6 ? Vec3f(0, -1, 0) : Vec3f(normalize(Vec3d(point(i, 4, 1.0))));
    result.push_back({middle - half, middle + half, axis, std::pow(10.0, 6.0 * number(i, 7) - 3.0), one_sided});
  }
  return result;
}

EmitterReceiver receiver(std::uint64_t i) {
  return {point(i, 10, 12.0), Vec3f(normalize(Vec3d(point(i, 13, 1.0)))), i % 3 == 0};
}

double total(const LightTree& tree, const EmitterReceiver& at) {
  double sum = 0.0;
  for (std::uint32_t e = 0; e < tree.size(); ++e) sum += tree.probability(at, e);
  return sum;
}

// On one side alone a box may reach above the surface where no box in it does: such a way finds nothing.
TEST(LightTree, ProbabilitiesSumToOneWhereBothSidesCount) {
  for (const std::size_t count : {1U, 2U, 3U, 17U, 500U}) {
    const LightTree tree(many(count));
    for (std::uint64_t i = 0; i < 40; ++i) {
      EmitterReceiver at = receiver(i);
      EXPECT_LE(total(tree, at), 1.0 + 1e-12) << count << ' ' << i;
      at.both_sides = true;
      EXPECT_NEAR(total(tree, at), 1.0, 1e-12) << count << ' ' << i;
    }
  }
  EXPECT_FALSE(LightTree().sample(receiver(0), 0.5));
}

TEST(LightTree, DrawsAsItsProbabilitiesSay) {
  const LightTree both(many(60)), fronts(many(60, true));
  const double level = support::sidak_level(12);
  for (std::uint64_t i = 0; i < 12; ++i) {
    const LightTree& tree = i % 2 == 0 ? both : fronts;
    constexpr int kDraws = 20000;
    const EmitterReceiver at = receiver(i);
    std::vector<double> seen(tree.size() + 1, 0.0), expected(tree.size() + 1);
    for (std::uint64_t k = 0; k < kDraws; ++k) {
      const auto drawn = tree.sample(at, number(k, 20 + i));
      if (!drawn) {
        seen.back() += 1.0;
        continue;
      }
      // Bit for bit: the weight of one way to find light is made with the density of the other.
      ASSERT_EQ(drawn->probability, tree.probability(at, drawn->emitter));
      seen[drawn->emitter] += 1.0;
    }
    for (std::uint32_t e = 0; e < tree.size(); ++e) expected[e] = kDraws * tree.probability(at, e);
    expected.back() = std::max(0.0, kDraws * (1.0 - total(tree, at)));
    EXPECT_GT(support::chi_square_p(seen, expected), level) << i;
  }
}

// What lies in front of a surface, however little of it, can be drawn; what is behind cannot.
// So for what shines to a side on which the surface is not.
TEST(LightTree, LeavesOutWhatIsBehindAndNothingElse) {
  const auto emitters = many(400, true);
  const LightTree tree(emitters);
  int turned_away = 0;
  for (std::uint64_t i = 0; i < 30; ++i) {
    const EmitterReceiver at = receiver(i);
    for (std::uint32_t e = 0; e < emitters.size(); ++e) {
      double highest = -1e300, before = -1e300;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const EmitterBounds& b = emitters[e];
        const Vec3d c((corner & 1U) != 0 ? b.hi.x : b.lo.x, (corner & 2U) != 0 ? b.hi.y : b.lo.y,
                      (corner & 4U) != 0 ? b.hi.z : b.lo.z);
        highest = std::max(highest, dot(c - Vec3d(at.p), Vec3d(at.normal)));
        before = std::max(before, dot(Vec3d(at.p) - c, Vec3d(b.axis)));
      }
      if (std::abs(highest) < 1e-6 && !at.both_sides) continue;
      if (std::abs(before) < 1e-6) continue;
      const bool faces = !emitters[e].one_sided || before > 0.0;
      EXPECT_EQ(tree.probability(at, e) > 0.0, (at.both_sides || highest > 0.0) && faces) << i << ' ' << e;
      turned_away += faces ? 0 : 1;
    }
  }
  EXPECT_GT(turned_away, 1000);
}

// Pairs of lamps back to back: a surface above draws the one that faces it, nearly always.
TEST(LightTree, DrawsOfTwoSidesTheOneThatFaces) {
  std::vector<EmitterBounds> pairs;
  for (int i = 0; i < 40; ++i) {
    const auto x = static_cast<float>(i);
    for (const float side : {1.0F, -1.0F}) pairs.push_back({{x, 0, 0}, {x + 0.5F, 0, 0.5F}, {0, side, 0}, 1.0 + i, true});
  }
  const LightTree tree(pairs);
  for (const float height : {0.3F, 3.0F, 100.0F}) {
    const EmitterReceiver at{{17.0F, height, 0.0F}, {0, -1, 0}, false};
    double facing = 0.0;
    for (std::uint32_t e = 0; e < pairs.size(); e += 2) facing += tree.probability(at, e);
    EXPECT_GT(facing, 0.95) << height;
  }
}

TEST(LightTree, FindsWhatIsNearAndWhatIsBright) {
  std::vector<EmitterBounds> emitters;
  const Vec3f up(0, 0, 1);
  for (int i = 0; i < 100; ++i) {
    const auto x = static_cast<float>(i);
    emitters.push_back({{x, 0, 1}, {x + 0.1F, 0.1F, 1}, up, 1.0});
  }
  // Huge and dim, tiny and bright: next to nothing in size, a tenth of all power.
  emitters.push_back({{-500, -500, 50}, {500, 500, 50}, up, 100.0});
  emitters.push_back({{60, 5, 1}, {60.001F, 5.001F, 1}, up, 20.0});
  const LightTree tree(emitters);
  const auto at = [](float x, float y) { return EmitterReceiver{{x, y, 0}, {0, 0, 1}, false}; };
  EXPECT_GT(tree.probability(at(20.0F, 0.0F), 20), 0.3);
  EXPECT_GT(tree.probability(at(60.0F, 5.0F), 101), 0.6);
  EXPECT_LT(tree.probability(at(20.0F, 0.0F), 101), 0.2);
}

TEST(LightTree, DrawsDoNotDependOnTheUnitOfLengthOrPower) {
  for (const int k : {-40, 30}) {
    const float scale = std::ldexp(1.0F, k);
    auto scaled = many(200);
    for (EmitterBounds& e : scaled) {
      e.lo *= scale;
      e.hi *= scale;
      e.power = std::ldexp(e.power, 2 * k);
    }
    const LightTree tree(many(200)), other(scaled);
    for (std::uint64_t i = 0; i < 500; ++i) {
      EmitterReceiver at = receiver(i);
      const auto drawn = tree.sample(at, number(i, 30));
      at.p *= scale;
      const auto again = other.sample(at, number(i, 30));
      ASSERT_EQ(drawn.has_value(), again.has_value());
      if (!drawn) continue;
      ASSERT_EQ(drawn->emitter, again->emitter);
      ASSERT_EQ(drawn->probability, again->probability);
    }
  }
}

TEST(LightTree, IsEmptyWhereItWasStopped) {
  std::stop_source source;
  const auto emitters = many(5000);
  EXPECT_EQ(LightTree(emitters, source.get_token()).size(), 5000U);
  source.request_stop();
  EXPECT_EQ(LightTree(emitters, source.get_token()).size(), 0U);
}

TEST(LightTree, StaysFlatInDegenerateCases) {
  EXPECT_LE(LightTree(many(30000)).depth(), 40);
  // All in one place, and each twice as far as the one before: no split by place helps, or every one takes one off.
  const std::vector<EmitterBounds> same(1000, {{1, 1, 1}, {2, 2, 1}, {0, 0, 1}, 1.0});
  EXPECT_EQ(LightTree(same).depth(), 10);
  std::vector<EmitterBounds> chain;
  for (int i = 0; i < 120; ++i) {
    const float x = std::ldexp(1.0F, i - 60);
    chain.push_back({{x, 0, 0}, {x * 1.01F, 0, x}, {0, 1, 0}, 1.0});
  }
  const LightTree tree(chain);
  EXPECT_LE(tree.depth(), 62);
  EXPECT_NEAR(total(tree, {{0, 1, 0}, {0, 1, 0}, true}), 1.0, 1e-12);
}

/// Triangles of a mesh, every other of which shines: the emitters' own door to the tree.
Scene striped() {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[1].emission = Rgb(2.0F);
  for (std::uint32_t i = 0; i < 120; ++i) {
    for (std::uint64_t c = 0; c < 3; ++c) scene.mesh.positions.push_back(point(i, 40 + 3 * c, 4.0));
    scene.mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    scene.mesh.material_ids.push_back(i % 2);
  }
  return scene;
}

TEST(Emitters, TreeDensityIsThatOfTheDraw) {
  const Scene scene = striped();
  const Emitters emitters(scene);
  EXPECT_TRUE(emitters.by_tree(EmitterChoice::kAuto));
  EXPECT_TRUE(emitters.by_tree(EmitterChoice::kTree));
  EXPECT_FALSE(emitters.by_tree(EmitterChoice::kPower));
  EXPECT_GE(emitters.bytes(), LightTree::bytes(60)) << "counted before it is built";
  for (std::uint64_t i = 0; i < 200; ++i) {
    const EmitterReceiver at = receiver(i);
    const EmitterSample s = emitters.sample(scene, vertex_key(path_key(5, i, 0), 0, 0), at);
    if (s.pdf_area == 0.0) continue;
    EXPECT_EQ(s.pdf_area, emitters.pdf_area(scene, s.triangle, at));
    EXPECT_EQ(emitters.pdf_area(scene, s.triangle - 1, at), 0.0) << "a dark triangle";
  }
}

// The tree is built by whoever asks first, while others wait; all see one that is whole.
TEST(Emitters, TreeIsTheSameForThreadsThatAskAtOnce) {
  const Scene scene = striped();
  const auto densities = [&scene](const Emitters& emitters) {
    std::vector<double> result;
    for (std::uint64_t i = 0; i < 50; ++i) {
      result.push_back(emitters.sample(scene, vertex_key(path_key(6, i, 0), 0, 0), receiver(i)).pdf_area);
    }
    return result;
  };
  const std::vector<double> expected = densities(Emitters(scene));
  const Emitters shared(scene);
  std::vector<std::vector<double>> seen(4);
  {
    std::vector<std::jthread> threads;
    for (auto& mine : seen) threads.emplace_back([&] { mine = densities(shared); });
  }
  for (const auto& mine : seen) EXPECT_EQ(mine, expected);
}

}  // namespace
}  // namespace raykiln::render
