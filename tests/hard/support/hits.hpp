// Rays in batches, and the comparison of the tree with the loop over all triangles.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "support/accel_testing.hpp"

namespace raykiln::hard {

using render::Hit;
using render::KdTree;
using render::Ray;
using test::TestMesh;
using test::TestRandom;

inline constexpr std::uint64_t kBatch = 4096;

/// Calls visit(rays, hits) for batches of `n` rays in all, each made by make().
template <typename Make, typename Visit>
void trace_batches(const KdTree& tree, std::uint64_t n, Make&& make, Visit&& visit) {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  for (std::uint64_t done = 0; done < n; done += rays.size()) {
    rays.resize(static_cast<std::size_t>(std::min(kBatch, n - done)));
    for (Ray& ray : rays) ray = make();
    hits.resize(rays.size());
    render::closest_hits(tree, rays, hits);
    visit(rays, hits);
  }
}

struct Tally {
  std::uint64_t rays = 0, hits = 0, compared = 0, mismatches = 0;
  Tally& operator+=(const Tally& other) {
    rays += other.rays;
    hits += other.hits;
    compared += other.compared;
    mismatches += other.mismatches;
    return *this;
  }
};

/// Traces n rays; the first `compare` of them are compared, bit for bit, with brute force.
template <typename Make>
Tally trace_and_compare(const KdTree& tree, std::uint64_t n, std::uint64_t compare, Make&& make) {
  Tally tally;
  std::vector<Hit> expected;
  trace_batches(tree, n, make, [&](const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
    tally.hits += test::count_hits(hits);
    const auto left = static_cast<std::size_t>(
        std::min<std::uint64_t>(rays.size(), compare - std::min(compare, tally.rays)));
    tally.rays += rays.size();
    if (left == 0) return;
    expected.resize(left);
    render::closest_hits(tree, std::span(rays).first(left), expected, {},
                         render::Traversal::kBruteForce);
    for (std::size_t i = 0; i < left; ++i) {
      if (test::same_bits(hits[i], expected[i])) continue;
      if (++tally.mismatches > 3) continue;
      const Ray& r = rays[i];
      ADD_FAILURE() << std::hexfloat << "o " << r.o.x << ' ' << r.o.y << ' ' << r.o.z << " d "
                    << r.d.x << ' ' << r.d.y << ' ' << r.d.z << ": tree " << hits[i].t << " id "
                    << hits[i].id << ", brute force " << expected[i].t << " id " << expected[i].id;
    }
    tally.compared += left;
  });
  return tally;
}

}  // namespace raykiln::hard
