#include "bin_search.hpp"

#include <algorithm>
#include <bit>

#include "key_sort.hpp"

namespace raykiln::render {
namespace {

/// Up to so many events their buckets' counts fit into one word; more are sorted and swept.
constexpr std::size_t kMostDealt = (std::size_t{1} << 20) - 1;
/// Of so few events all planes are counted.
constexpr std::size_t kCountedInBin = 32;
static_assert(kCountedInBin <= kCountingMax);
constexpr unsigned kMostBucketBits = 8;

/// How many events there are, and what they begin and end, in 21 bits each.
class EventCounts {
 public:
  void clear() { bits_ = 0; }
  void add(EventType type) { bits_ += kOf[static_cast<std::size_t>(type)]; }
  [[nodiscard]] std::uint32_t all() const { return static_cast<std::uint32_t>(bits_ & kMask); }
  [[nodiscard]] std::uint32_t begun() const { return static_cast<std::uint32_t>(bits_ >> 21 & kMask); }
  [[nodiscard]] std::uint32_t gone() const { return static_cast<std::uint32_t>(bits_ >> 42); }

 private:
  static constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  static constexpr std::uint64_t kBegun = std::uint64_t{1} << 21, kGone = std::uint64_t{1} << 42;
  static constexpr std::array<std::uint64_t, 4> kOf{1 + kGone, 1 + kBegun + kGone, 1 + kBegun, 1};
  std::uint64_t bits_;
};

/// Neighbouring positions, some bits of whose ranks are the same.
struct Bucket {
  std::uint32_t begin, end;
  std::uint32_t n_left, n_gone;  ///< before it
  double least;
  bool beyond;  ///< all its planes are beyond the budget
};

}  // namespace

void BinSearch::run(std::span<EventKey> events, const SweepInput& input, std::uint32_t n_left,
                    std::uint32_t n_gone, const RoughCost& rough, const Known& known, PlaneChooser& chooser,
                    BuildStats& counts) {
  if (events.size() > kMostDealt) {
    counts.keys_sorted_passes += sort_keys(events, kEventIdBits, other_, &context_);
    counts.events_swept += events.size();
    sweep(events, input, chooser.axis(), n_left, n_gone, chooser);
    return;
  }
  if (events.size() > kCountedInBin && other_.size() < events.size()) other_.resize(events.size());
  look({input, rough, chooser, counts, known}, events, other_.data(), n_left, n_gone);
}

void BinSearch::look(const Search& search, std::span<EventKey> events, EventKey* other,
                     std::uint32_t n_left, std::uint32_t n_gone) {
  if (events.size() <= kCountedInBin) {
    count(search, events, n_left, n_gone);
  } else {
    deal(search, events, other, n_left, n_gone);
  }
}

void BinSearch::deal(const Search& search, std::span<EventKey> events, EventKey* other,
                     std::uint32_t n_left, std::uint32_t n_gone) {
  std::uint32_t lowest = event_rank(events[0]);
  std::uint32_t highest = lowest;
  for (const EventKey key : events) {
    lowest = std::min(lowest, event_rank(key));
    highest = std::max(highest, event_rank(key));
  }
  search.counts.events_swept += events.size();
  if (lowest == highest) {
    sweep(events, search.input, search.chooser.axis(), n_left, n_gone, search.chooser);
    return;
  }
  const auto wanted = static_cast<unsigned>(std::bit_width(events.size() / 8));
  const unsigned bits = std::min(std::clamp(wanted, 3U, kMostBucketBits),
                                 static_cast<unsigned>(std::bit_width(highest - lowest)));
  const unsigned shift = static_cast<unsigned>(std::bit_width(highest - lowest)) - bits;
  const std::size_t n = (std::size_t{highest - lowest} >> shift) + 1;
  std::array<EventCounts, std::size_t{1} << kMostBucketBits> counted;
  for (EventCounts& c : std::span(counted).first(n)) c.clear();
  for (const EventKey key : events) {
    counted[(event_rank(key) - lowest) >> shift].add(event_type(key));
  }

  std::array<Bucket, std::size_t{1} << kMostBucketBits> buckets;
  std::array<std::uint32_t, std::size_t{1} << kMostBucketBits> place;
  std::uint32_t at = 0;
  std::size_t used = 0;
  std::size_t first = 0;
  const Known known = search.known();
  for (std::size_t b = 0; b < n; ++b) {
    const EventCounts& c = counted[b];
    place[b] = at;
    if (c.all() == 0) continue;
    const std::uint32_t from = lowest + (static_cast<std::uint32_t>(b) << shift);
    const std::uint32_t to = std::min(highest, from + ((std::uint32_t{1} << shift) - 1));
    const double bound = search.chooser.cost().at_least(rank_to_float(from), rank_to_float(to), n_left,
                                                        search.input.n - n_gone - c.gone(), search.input.n);
    const bool beyond = n_left > n_gone + c.gone() + search.input.budget;
    if (!(bound > known.limit(beyond))) {
      buckets[used] = {at, at + c.all(), n_left, n_gone, bound, beyond};
      if (bound < buckets[first].least) first = used;
      ++used;
    }
    at += c.all();
    n_left += c.begun();
    n_gone += c.gone();
  }
  if (used == 0) return;
  search.counts.keys_sorted_passes += events.size();
  for (const EventKey key : events) other[place[(event_rank(key) - lowest) >> shift]++] = key;
  std::swap(buckets[0], buckets[first]);
  for (const Bucket& bucket : std::span(buckets).first(used)) {
    if (bucket.least > search.known().limit(bucket.beyond)) continue;
    if (events.size() >= kStopInterval && context_.stopped()) return;
    look(search, {other + bucket.begin, bucket.end - bucket.begin}, events.data() + bucket.begin,
         bucket.n_left, bucket.n_gone);
  }
}

void BinSearch::count(const Search& search, std::span<const EventKey> events, std::uint32_t n_left,
                      std::uint32_t n_gone) {
  std::array<float, kCountedInBin + 1> lows, highs, planars;
  std::uint32_t n_lows = 0;
  std::uint32_t n_highs = 0;
  std::uint32_t n_planars = 0;
  for (const EventKey key : events) {
    const float position = rank_to_float(event_rank(key));
    const EventType type = event_type(key);
    lows[n_lows] = highs[n_highs] = planars[n_planars] = position;
    n_lows += type != EventType::kEnd ? 1U : 0U;
    n_highs += type != EventType::kStart ? 1U : 0U;
    n_planars += type == EventType::kPlanar ? 1U : 0U;
  }
  search.counts.events_swept += events.size();
  PlaneChooser& chooser = search.chooser;
  const SweepInput& input = search.input;
  const auto axis = static_cast<std::uint32_t>(chooser.axis());
  const float lo = input.cell.lo[chooser.axis()], hi = input.cell.hi[chooser.axis()];
  std::array<CountedPlane, 2 * kCountedInBin> planes;
  CountedPlanes found{planes.data(), 0, 0};
  RoughCost cost = search.rough;
  cost.usable &= hi - lo > 1e-30F && hi - lo < 1e30F;
  const Known known = search.known();
  context_.kernels.count_planes_of_bin(
      {lows.data(), highs.data(), planars.data(), n_lows, n_highs, n_planars,
       static_cast<std::int32_t>(n_left), static_cast<std::int32_t>(input.n - n_gone - n_highs),
       static_cast<std::int32_t>(input.n),
       static_cast<std::int32_t>(input.n + std::min<std::uint64_t>(input.budget, input.n)), axis, lo, hi,
       1.0F / (hi - lo), cost, static_cast<float>(known.least), static_cast<float>(known.limit(true))},
      found);
  search.counts.keys_sorted_passes += found.operations;
  for (const CountedPlane& plane : std::span(planes).first(found.size)) {
    chooser.consider(plane.position, plane.n_left + plane.n_planar, plane.n_right, true);
    if (plane.n_planar > 0) {
      chooser.consider(plane.position, plane.n_left, plane.n_right + plane.n_planar, false);
    }
  }
}

}  // namespace raykiln::render
