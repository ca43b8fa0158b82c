// Which walks this processor can run, and which one it runs when nobody asks.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "raykiln/accel/kdtree.hpp"

namespace raykiln::render {

/// Names the kernel that Traversal::kTree stands for: scalar, avx2 or avx512. Read once, at the
/// first query; an unknown name or one that the processor cannot run counts as absent.
inline constexpr const char* kKernelVariable = "RAYKILN_KERNEL";

enum class TriangleTest : std::uint8_t { kWatertight, kFast };
[[nodiscard]] TriangleTest test_of(Traversal traversal);

/// The same walk with the other test, or with the one it has.
[[nodiscard]] Traversal with_test(Traversal traversal, TriangleTest test);

/// True when the processor, its operating system and this build can run it.
[[nodiscard]] bool is_available(Traversal traversal);

/// What is run when `wanted` is asked for: kTree becomes the kernel named by kKernelVariable or else
/// the fastest available; what is not available becomes kScalar. The test stays the same.
[[nodiscard]] Traversal resolve(Traversal wanted);

/// scalar, avx2, avx512, tree or brute; with the fast test fast-scalar and so on.
[[nodiscard]] std::string_view name(Traversal traversal);
[[nodiscard]] std::optional<Traversal> traversal_named(std::string_view name);

}  // namespace raykiln::render
