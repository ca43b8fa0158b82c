// Splitting a cell: classify its triangles, clip those on both sides, keep all events sorted.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "build_context.hpp"
#include "event_key.hpp"
#include "sah_sweep.hpp"

namespace raykiln::render {

/// Adds the one or two events of an extent.
inline void append_events(float lo, float hi, std::uint32_t id, std::vector<EventKey>& events) {
  if (event_rank(make_event(lo, EventType::kPlanar, 0)) ==
      event_rank(make_event(hi, EventType::kPlanar, 0))) {
    events.push_back(make_event(lo, EventType::kPlanar, id));
    return;
  }
  events.push_back(make_event(lo, EventType::kStart, id));
  events.push_back(make_event(hi, EventType::kEnd, id));
}

/// Four stacks: the events of each axis and the ids of the cells that wait to be built, the cell
/// in work on top. Splitting replaces the top by its left and then its right child, so the
/// memory in use is that of the live references.
struct EventStacks {
  std::array<std::vector<EventKey>, 3> events;
  std::vector<std::uint32_t> ids;  ///< ascending within a cell
};

/// Where a cell begins in the stacks; it ends where the next one begins.
struct StackMark {
  std::array<std::size_t, 3> events{};
  std::size_t ids = 0;
};

[[nodiscard]] StackMark top_of(const EventStacks& stacks);
void cut_to(EventStacks& stacks, const StackMark& mark);

/// Does the splits of one subtree; owns the memory that they need again and again.
class EventPartition {
 public:
  /// `mesh_ids` maps the ids of the events to triangles of the mesh and must outlive this.
  EventPartition(BuildContext& context, const std::vector<std::uint32_t>& mesh_ids)
      : context_(context), mesh_ids_(mesh_ids), side_(mesh_ids.size()) {}

  /// Replaces the top cell, which begins at `begin`, by its left part, which begins there too,
  /// and its right part, which begins at the returned mark. A triangle on both sides whose clipped
  /// part is empty on one is not referenced there.
  StackMark split(EventStacks& stacks, const StackMark& begin, const Bounds3f& cell,
                  const SplitPlane& plane, BuildStats& counts);

 private:
  enum class Side : std::uint8_t { kLeft = 1, kRight = 2, kBoth = 3 };
  enum : std::size_t { kLeftPart = 0, kRightPart = 1 };
  struct AxisScratch {
    std::vector<EventKey> right;                  ///< events of the right part, as they pass by
    std::array<std::vector<EventKey>, 2> fresh;   ///< events of clipped parts
    std::vector<std::uint64_t> sort;
    std::uint64_t moved = 0, sorted = 0;
  };

  void classify(const EventStacks& stacks, const StackMark& begin, const SplitPlane& plane);
  void clip_straddlers(EventStacks& stacks, std::size_t ids_begin, const Bounds3f& cell,
                       const SplitPlane& plane, BuildStats& counts);
  void add_clipped(std::uint32_t id, const Bounds3f& cell, std::size_t part,
                   std::vector<std::uint32_t>& ids);
  std::size_t splice_axis(std::vector<EventKey>& events, std::size_t begin, AxisScratch& scratch);

  BuildContext& context_;
  const std::vector<std::uint32_t>& mesh_ids_;
  std::vector<Side> side_;
  std::vector<std::uint32_t> left_ids_, right_ids_;
  std::array<AxisScratch, 3> axes_;
};

}  // namespace raykiln::render
