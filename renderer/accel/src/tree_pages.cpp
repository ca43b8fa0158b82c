#include "tree_pages.hpp"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace raykiln::render {

namespace {

// Declined where the system has no large page to give: then all stays as it is.
void advise(const void* begin, std::size_t bytes, int advice) {
#ifdef __linux__
  constexpr std::uintptr_t kPage = std::uintptr_t{1} << 21;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + kPage - 1) / kPage * kPage;
  const std::uintptr_t end = (address + bytes) / kPage * kPage;
  if (first < end) (void)madvise(reinterpret_cast<void*>(first), end - first, advice);
#else
  (void)begin, (void)bytes, (void)advice;
#endif
}

constexpr int kHugePage = 14;  // MADV_HUGEPAGE
constexpr int kCollapse = 25;  // MADV_COLLAPSE, since Linux 6.1; older headers do not name it

}  // namespace

void prefer_large_pages(const void* begin, std::size_t bytes) { advise(begin, bytes, kCollapse); }
void expect_large_pages(const void* begin, std::size_t bytes) { advise(begin, bytes, kHugePage); }

}  // namespace raykiln::render
