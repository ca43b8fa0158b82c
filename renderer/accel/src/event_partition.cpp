#include "event_partition.hpp"

#include <algorithm>

#include "key_sort.hpp"
#include "polygon_clip.hpp"
#include "subtree_builder.hpp"

namespace raykiln::render {
namespace {

// Merges the sorted `fresh` into the sorted tail of `events` that begins at `begin`, from behind.
void merge_into_tail(std::vector<EventKey>& events, std::size_t begin,
                     const std::vector<EventKey>& fresh) {
  std::size_t old = events.size();
  std::size_t add = fresh.size();
  events.resize(old + add);
  for (std::size_t to = events.size(); add > 0;) {
    --to;
    if (old > begin && events[old - 1] > fresh[add - 1]) {
      events[to] = events[--old];
    } else {
      events[to] = fresh[--add];
    }
  }
}

}  // namespace

StackMark top_of(const EventStacks& stacks) {
  return {{stacks.events[0].size(), stacks.events[1].size(), stacks.events[2].size()},
          stacks.ids.size()};
}

void cut_to(EventStacks& stacks, const StackMark& mark) {
  for (std::size_t a = 0; a < 3; ++a) stacks.events[a].resize(mark.events[a]);
  stacks.ids.resize(mark.ids);
}

StackMark EventPartition::split(EventStacks& stacks, const StackMark& begin, const Bounds3f& cell,
                                const SplitPlane& plane, BuildStats& counts) {
  const bool parallel = stacks.ids.size() - begin.ids >= kParallelMin;
  classify(stacks, begin, plane);
  counts.events_moved +=
      stacks.events[static_cast<std::size_t>(plane.axis)].size() -
      begin.events[static_cast<std::size_t>(plane.axis)];
  clip_straddlers(stacks, begin.ids, cell, plane, counts);

  StackMark right;
  right.ids = begin.ids + left_ids_.size();
  stacks.ids.resize(begin.ids);
  stacks.ids.insert(stacks.ids.end(), left_ids_.begin(), left_ids_.end());
  stacks.ids.insert(stacks.ids.end(), right_ids_.begin(), right_ids_.end());
  context_.for_each_axis(parallel, [&](int axis) {
    const auto a = static_cast<std::size_t>(axis);
    right.events[a] = splice_axis(stacks.events[a], begin.events[a], axes_[a]);
  });
  for (const AxisScratch& scratch : axes_) {
    counts.events_moved += scratch.moved;
    counts.keys_sorted_passes += scratch.sorted;
  }
  return right;
}

// Wald & Havran 2006, algorithm 6: everything is on both sides unless an event shows otherwise.
void EventPartition::classify(const EventStacks& stacks, const StackMark& begin,
                              const SplitPlane& plane) {
  for (std::size_t i = begin.ids; i < stacks.ids.size(); ++i) side_[stacks.ids[i]] = Side::kBoth;
  const auto axis = static_cast<std::size_t>(plane.axis);
  const auto& events = stacks.events[axis];
  const std::uint32_t rank = ordered_key(plane.position);
  const std::size_t first = begin.events[axis];
  context_.in_pieces(events.size() - first, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = first + from; i < first + to; ++i) {
      const std::uint32_t at = event_rank(events[i]);
      const EventType type = event_type(events[i]);
      if (type == EventType::kPlanar) {
        const bool left = at < rank || (at == rank && plane.planar_left);
        side_[event_id(events[i])] = left ? Side::kLeft : Side::kRight;
      } else if (type == EventType::kEnd) {
        if (at <= rank) side_[event_id(events[i])] = Side::kLeft;
      } else if (at >= rank) {
        side_[event_id(events[i])] = Side::kRight;
      }
    }
  });
}

void EventPartition::clip_straddlers(EventStacks& stacks, std::size_t ids_begin,
                                     const Bounds3f& cell, const SplitPlane& plane,
                                     BuildStats& counts) {
  Bounds3f left_cell = cell;
  Bounds3f right_cell = cell;
  left_cell.hi[plane.axis] = right_cell.lo[plane.axis] = plane.position;
  left_ids_.clear();
  right_ids_.clear();
  for (AxisScratch& scratch : axes_) {
    for (auto& fresh : scratch.fresh) fresh.clear();
  }
  context_.in_pieces(stacks.ids.size() - ids_begin, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = ids_begin + from; i < ids_begin + to; ++i) {
      const std::uint32_t id = stacks.ids[i];
      if (side_[id] == Side::kLeft) {
        left_ids_.push_back(id);
      } else if (side_[id] == Side::kRight) {
        right_ids_.push_back(id);
      } else {
        counts.clips += 2;
        add_clipped(id, left_cell, kLeftPart, left_ids_);
        add_clipped(id, right_cell, kRightPart, right_ids_);
      }
    }
  });
}

void EventPartition::add_clipped(std::uint32_t id, const Bounds3f& cell, std::size_t part,
                                 std::vector<std::uint32_t>& ids) {
  const auto bounds = clipped_bounds(context_.corners(mesh_ids_[id]), cell);
  if (!bounds) return;
  ids.push_back(id);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    append_events(bounds->lo[axis], bounds->hi[axis], id, axes_[a].fresh[part]);
  }
}

std::size_t EventPartition::splice_axis(std::vector<EventKey>& events, std::size_t begin,
                                        AxisScratch& scratch) {
  const std::size_t n = events.size() - begin;
  if (scratch.right.size() < n + 1) scratch.right.resize(n + 1);
  std::size_t left_end = begin;
  std::size_t right_end = 0;
  EventKey* const right = scratch.right.data();
  context_.in_pieces(n, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = begin + from; i < begin + to; ++i) {
      const EventKey key = events[i];
      const Side side = side_[event_id(key)];
      events[left_end] = key;  // always written, kept only when counted: no branch to mispredict
      right[right_end] = key;
      left_end += side == Side::kLeft ? 1U : 0U;
      right_end += side == Side::kRight ? 1U : 0U;
    }
  });
  scratch.sorted = 0;
  for (auto& fresh : scratch.fresh) {
    scratch.sorted += sort_keys(fresh, kEventIdBits, scratch.sort, &context_);
  }
  events.resize(left_end);
  merge_into_tail(events, begin, scratch.fresh[kLeftPart]);
  const std::size_t right_begin = events.size();
  events.insert(events.end(), right, right + right_end);
  merge_into_tail(events, right_begin, scratch.fresh[kRightPart]);
  scratch.moved = n + scratch.fresh[kLeftPart].size() + scratch.fresh[kRightPart].size();
  return right_begin;
}

}  // namespace raykiln::render
