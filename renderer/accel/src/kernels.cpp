#include "raykiln/accel/kernels.hpp"

#include <array>
#include <cstdlib>
#include <utility>

#include "build_kernels.hpp"

namespace raykiln::render {
namespace {

constexpr std::array<std::pair<std::string_view, Traversal>, 10> kNames{{
    {"tree", Traversal::kTree},
    {"brute", Traversal::kBruteForce},
    {"scalar", Traversal::kScalar},
    {"avx2", Traversal::kAvx2},
    {"avx512", Traversal::kAvx512},
    {"fast-tree", Traversal::kFastTree},
    {"fast-brute", Traversal::kFastBruteForce},
    {"fast-scalar", Traversal::kFastScalar},
    {"fast-avx2", Traversal::kFastAvx2},
    {"fast-avx512", Traversal::kFastAvx512},
}};

constexpr int kFirstFast = static_cast<int>(Traversal::kFastTree);

// What the units of the kernels are compiled for; the compiler's functions ask the operating system
// too whether it keeps the registers.
#ifdef RAYKILN_X86_KERNELS
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
         __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0 &&
         __builtin_cpu_supports("popcnt") != 0;
}
bool has_avx512() {
  return has_avx2() && __builtin_cpu_supports("avx512f") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
}
#else
bool has_avx2() { return false; }
bool has_avx512() { return false; }
#endif

Traversal choose() {
  if (const char* wanted = std::getenv(kKernelVariable)) {
    const auto traversal = traversal_named(wanted);
    if (traversal && *traversal != Traversal::kTree && *traversal != Traversal::kBruteForce &&
        test_of(*traversal) == TriangleTest::kWatertight && is_available(*traversal)) {
      return *traversal;
    }
  }
  if (has_avx512()) return Traversal::kAvx512;
  return has_avx2() ? Traversal::kAvx2 : Traversal::kScalar;
}

}  // namespace

TriangleTest test_of(Traversal traversal) {
  return static_cast<int>(traversal) < kFirstFast ? TriangleTest::kWatertight : TriangleTest::kFast;
}

Traversal with_test(Traversal traversal, TriangleTest test) {
  const int walk = static_cast<int>(traversal) % kFirstFast;
  return static_cast<Traversal>(test == TriangleTest::kFast ? walk + kFirstFast : walk);
}

bool is_available(Traversal traversal) {
  switch (with_test(traversal, TriangleTest::kWatertight)) {
    case Traversal::kAvx2: return has_avx2();
    case Traversal::kAvx512: return has_avx512();
    default: return true;
  }
}

Traversal resolve(Traversal wanted) {
  const TriangleTest test = test_of(wanted);
  if (with_test(wanted, TriangleTest::kWatertight) == Traversal::kTree) {
    static const Traversal chosen = choose();
    return with_test(chosen, test);
  }
  return is_available(wanted) ? wanted : with_test(Traversal::kScalar, test);
}

const BuildKernels* avx2_build_kernels() {
#ifdef RAYKILN_X86_KERNELS
  if (has_avx2()) return &kAvx2BuildKernels;
#endif
  return nullptr;
}

const BuildKernels& build_kernels() {
  const BuildKernels* const avx2 = avx2_build_kernels();
  return avx2 != nullptr && resolve(Traversal::kTree) != Traversal::kScalar ? *avx2 : kAnyBuildKernels;
}

std::string_view name(Traversal traversal) {
  for (const auto& [text, value] : kNames) {
    if (value == traversal) return text;
  }
  return "";
}

std::optional<Traversal> traversal_named(std::string_view name) {
  for (const auto& [text, value] : kNames) {
    if (text == name) return value;
  }
  return std::nullopt;
}

}  // namespace raykiln::render
