#include "build_context.hpp"

#include <algorithm>
#include <cmath>

#include "raykiln/accel/kdtree_data.hpp"

namespace raykiln::render {
namespace {

double finite_or(double value, double fallback) { return std::isfinite(value) ? value : fallback; }

BuildParams sane(BuildParams p) {
  const BuildParams defaults;
  p.k_t = std::max(0.0, finite_or(p.k_t, defaults.k_t));
  p.k_i = std::max(0.0, finite_or(p.k_i, defaults.k_i));
  p.empty_factor = std::clamp(finite_or(p.empty_factor, defaults.empty_factor), 0.0, 1.0);
  p.max_duplication =
      std::clamp(finite_or(p.max_duplication, defaults.max_duplication), 1.0, 1024.0);
  p.max_depth = std::clamp(p.max_depth, 0, kMaxKdDepth);
  p.leaf_width = p.leaf_width == 16 ? 16 : 8;
  return p;
}

}  // namespace

BuildContext::BuildContext(const TriangleView& m, const BuildParams& p, TaskRunner& r)
    : kernels(build_kernels()), mesh(m), params(sane(p)), runner(r), concurrent(r.concurrency() > 1) {}

bool BuildContext::stopped() {
  if (stopped_.load(std::memory_order_relaxed)) return true;
  if (!runner.stop_requested()) return false;
  stopped_.store(true, std::memory_order_relaxed);
  return true;
}

void BuildContext::for_each(std::size_t n, const std::function<void(std::size_t)>& body) {
  if (!concurrent || n < 2) {
    for (std::size_t i = 0; i < n; ++i) body(i);
    return;
  }
  std::vector<std::function<void()>> tasks;
  tasks.reserve(n);
  for (std::size_t i = 0; i < n; ++i) tasks.emplace_back([&body, i] { body(i); });
  runner.run(tasks);
}

void BuildContext::finished(double share) {
  constexpr double kWhole = 0x1p40;
  const auto units = static_cast<std::uint64_t>(share * kWhole);
  const double fraction =
      std::min(1.0, static_cast<double>(done_.fetch_add(units) + units) / kWhole);
  const auto percent = static_cast<std::uint64_t>(fraction * 100.0);
  std::uint64_t last = reported_.load(std::memory_order_relaxed);
  if (percent > last && reported_.compare_exchange_strong(last, percent)) runner.progress(fraction);
}

}  // namespace raykiln::render
