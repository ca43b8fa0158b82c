// The builder's sort against the reference sort, byte for byte.
#include "key_sort.hpp"

#include <gtest/gtest.h>

#include "event_key.hpp"
#include "support/median_of_medians_sort.hpp"
#include "support/mesh_generators.hpp"

namespace raykiln::test {
namespace {

using Keys = std::vector<std::uint64_t>;

void expect_reference_order(Keys keys, unsigned low_bit) {
  Keys expected = keys;
  median_of_medians_sort(std::span(expected), std::less<>());
  EXPECT_TRUE(std::is_sorted(expected.begin(), expected.end()));
  Keys scratch;
  const std::uint64_t operations = render::sort_keys(keys, low_bit, scratch);
  EXPECT_EQ(keys, expected) << keys.size() << " keys from bit " << low_bit;
  if (keys.size() >= render::kRadixSortMin) {
    EXPECT_LE(operations, 8 * keys.size()) << "linear";
  }
}

// Events in the order of their ids, as the builder makes them.
Keys random_events(std::size_t n, bool few_positions) {
  TestRandom random(n);
  Keys keys;
  for (std::uint32_t id = 0; keys.size() < n; ++id) {
    const float a = few_positions ? static_cast<float>(random.below(3)) - 1.0F
                                  : random.uniform(-1e6F, 1e6F);
    keys.push_back(make_event(a, render::EventType::kStart, id));
    keys.push_back(make_event(a + random.uniform(), render::EventType::kEnd, id));
  }
  keys.resize(n);
  return keys;
}

TEST(KeySort, AgreesWithTheReferenceSort) {
  for (const std::size_t n : {0U, 1U, 2U, 5U, 255U, 256U, 257U, 1000U, 8191U, 8192U, 100'000U}) {
    TestRandom random(n);
    Keys keys(n);
    for (auto& key : keys) key = random.bits();
    expect_reference_order(keys, 0);
    std::sort(keys.begin(), keys.end());
    expect_reference_order(keys, 0);
    std::reverse(keys.begin(), keys.end());
    expect_reference_order(keys, 0);
    expect_reference_order(Keys(n, 42), 0);
    expect_reference_order(random_events(n, false), render::kEventIdBits);
    expect_reference_order(random_events(n, true), render::kEventIdBits);
  }
}

TEST(KeySort, EventOrderIsPositionThenTypeThenId) {
  using render::EventType;
  const Keys ordered{
      make_event(-1e30F, EventType::kStart, 9), make_event(-1.0F, EventType::kEnd, 3),
      make_event(-0.0F, EventType::kEnd, 1),    make_event(0.0F, EventType::kEnd, 2),
      make_event(-0.0F, EventType::kPlanar, 0), make_event(0.0F, EventType::kStart, 0),
      make_event(1e-45F, EventType::kEnd, 0),   make_event(3e38F, EventType::kPlanar, 0)};
  EXPECT_TRUE(std::is_sorted(ordered.begin(), ordered.end()));
  EXPECT_EQ(render::event_id(ordered[0]), 9U);
  EXPECT_EQ(render::event_type(ordered[7]), EventType::kPlanar);
  EXPECT_EQ(render::rank_to_float(render::event_rank(ordered[0])), -1e30F);
  EXPECT_EQ(render::rank_to_float(render::event_rank(ordered[2])), 0.0F);
  EXPECT_EQ(render::rank_to_float(render::event_rank(ordered[6])), 1e-45F);
}

}  // namespace
}  // namespace raykiln::test
