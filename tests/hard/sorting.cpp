// K06: sorting and selecting when all keys are equal, or only two are distinct.
#include <bit>
#include <cmath>
#include <numeric>

#include "hard/support/hard_meshes.hpp"
#include "hard/support/hits.hpp"
#include "hard/support/report.hpp"
#include "key_sort.hpp"
#include "support/median_of_medians_sort.hpp"

namespace raykiln::hard {
namespace {

constexpr std::size_t kMillion = 1'000'000;

using Keys = std::vector<std::uint64_t>;

// Ordered bits of a coordinate above its index, as the builder makes them.
Keys keys_of(const std::vector<float>& values) {
  Keys keys(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    keys[i] = std::uint64_t{render::ordered_key(values[i])} << 32 | i;
  }
  return keys;
}

struct KeyFamily {
  const char* name;
  std::vector<float> values;
};

std::vector<KeyFamily> families() {
  TestRandom random(601);
  std::vector<KeyFamily> result{{"all equal", std::vector<float>(kMillion, 1.5F)},
                                {"two values", {}}, {"alternating zeros", {}}, {"sorted", {}},
                                {"random", {}}};
  for (std::size_t i = 0; i < kMillion; ++i) {
    result[1].values.push_back((random.bits() & 1) != 0 ? 2.0F : -3.0F);
    result[2].values.push_back(i % 2 == 0 ? -0.0F : 0.0F);
    result[3].values.push_back(static_cast<float>(i));
    result[4].values.push_back(random.uniform(-1e3F, 1e3F));
  }
  return result;
}

TEST(K06_EqualKeys, ProductSort) {
  Row row("K06", "1e6 keys: all equal, two values, alternating -0 and +0, sorted, random",
          "linear whatever the keys: <= 12 passes; equals std::sort");
  double most = 0.0;
  std::uint64_t wrong = 0;
  for (const KeyFamily& family : families()) {
    Keys keys = keys_of(family.values);
    Keys expected = keys;
    std::sort(expected.begin(), expected.end());
    std::vector<std::uint64_t> scratch;
    const auto moved = render::sort_keys(keys, 0, scratch);
    most = std::max(most, static_cast<double>(moved) / static_cast<double>(kMillion));
    wrong += keys == expected ? 0U : 1U;
  }
  row.measured("keys moved a key", most);
  row.never("orders that differ from std::sort", wrong, 5);
  EXPECT_EQ(wrong, 0U);
  EXPECT_LE(most, 12.0);
}

// The seed's own sort, kept as the reference: values alone, so that equal ones are equal.
TEST(K06_EqualKeys, MedianOfMediansReference) {
  Row row("K06", "the same values without index: quicksort about the median of medians, and selection",
          "selection <= 34 N comparisons, sort <= 40 N lg N, depth <= 4 lg N; equals std::sort");
  const auto n = static_cast<double>(kMillion);
  double select = 0.0, sort = 0.0, depth = 0.0;
  std::uint64_t wrong = 0;
  for (const KeyFamily& family : families()) {
    std::vector<std::uint32_t> keys;
    for (const float value : family.values) keys.push_back(render::ordered_key(value));
    auto expected = keys;
    std::sort(expected.begin(), expected.end());
    std::uint64_t comparisons = 0;
    const auto less = [&comparisons](std::uint32_t a, std::uint32_t b) {
      ++comparisons;
      return a < b;
    };
    auto some = keys;
    const auto middle = test::select_kth(std::span(some), kMillion / 3, less);
    wrong += middle == expected[kMillion / 3] ? 0U : 1U;
    select = std::max(select, static_cast<double>(comparisons) / n);
    comparisons = 0;
    const int deepest = test::median_of_medians_sort(std::span(keys), less);
    wrong += keys == expected ? 0U : 1U;
    sort = std::max(sort, static_cast<double>(comparisons) / (n * std::log2(n)));
    depth = std::max(depth, static_cast<double>(deepest) / std::log2(n));
  }
  row.measured("selection, comparisons/N", select);
  row.measured("sort, comparisons/(N lg N)", sort);
  row.measured("depth/lg N", depth);
  row.never("wrong results", wrong, 10);
  EXPECT_EQ(wrong, 0U);
  EXPECT_LE(select, 34.0);
  EXPECT_LE(sort, 40.0);
  EXPECT_LE(depth, 4.0);
}

// A ribbon of 2 n triangles from the plane x = 0 to x = 1: the same smallest x for all of them.
TestMesh ribbon(std::uint32_t n, TestRandom& random) {
  TestMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i) {
    const float y = static_cast<float>(i) * 1e-3F;
    const float z = random.uniform();
    mesh.positions.emplace_back(0.0F, y, z);
    mesh.positions.emplace_back(1.0F, y, z + 0.01F * random.uniform());
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  return mesh;
}

double operations_per_n_lg_n(const render::BuildStats& stats) {
  const auto n = static_cast<double>(stats.triangles);
  return static_cast<double>(stats.events_swept + stats.events_moved + stats.keys_sorted_passes) /
         (n * std::log2(n));
}

TEST(K06_EqualKeys, AMillionTrianglesBetweenTwoPlanes) {
  Row row("K06", "terrain of 1e6 triangles between two vertical planes: the same min x for all",
          "operations/(N lg N) at 1e6 at most those at 1e4; hits equal brute force");
  TestRandom random(602);
  const double small = operations_per_n_lg_n(render::build_stats(*test::build(ribbon(5000, random))));
  const std::uint32_t n = tests::kSanitized ? 50'000 : 500'000;
  const TestMesh mesh = ribbon(n, random);
  const double start = cpu_seconds();
  const auto tree = test::build(mesh);
  const double seconds = cpu_seconds() - start;
  const double ratio = operations_per_n_lg_n(render::build_stats(*tree));
  const Tally tally = trace_and_compare(*tree, 300, 300, [&] {
    return test::ray_to(random.in_box(-1.0F, 2.0F) * Vec3f(1.0F, 500.0F, 1.0F),
                        mesh.positions[random.below(2 * n)]);
  });
  row.measured("build s", seconds);
  row.measured("operations/(N lg N) at 1e4", small);
  row.measured("at 1e6", ratio);
  row.never("differences", tally.mismatches, tally.compared);
  EXPECT_LE(ratio, small);
  EXPECT_EQ(tally.mismatches, 0U);
}

}  // namespace
}  // namespace raykiln::hard
