// Whether this build looks for faults rather than for rates.
#pragma once

namespace raykiln::tests {

/// Under a sanitizer programs take ten times as long: statistics do with a fraction of their trials, and what a
/// fraction cannot tell is left to the other builds.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace raykiln::tests
