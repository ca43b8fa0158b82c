// Which piece of a job's film is rendered next. Pure decisions: no clock, no threads, no pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace raykiln::server {

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct TileRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] std::uint64_t pixels() const {
    return static_cast<std::uint64_t>(x1 - x0) * static_cast<std::uint64_t>(y1 - y0);
  }
  friend bool operator==(const TileRect&, const TileRect&) = default;
};

/// One task: the blocks [first_block, end_block) of some rectangles, each a tile or a band of one.
struct WorkItem {
  std::uint64_t id = 0;  ///< unique within the plan
  int attempt = 1;
  std::size_t first_block = 0, end_block = 0;
  struct Part {
    std::size_t tile = 0;
    TileRect rect;
  };
  std::vector<Part> parts;
};

/// How long a task is meant to last, and how much memory its result may take.
struct TaskLength {
  double low_seconds = 0.005, target_seconds = 0.025, high_seconds = 0.050;
  std::uint64_t least_stream = 1024;             ///< samples a band keeps, for long ray streams
  std::uint64_t max_pixel_blocks = 64 * 1024;    ///< pixels times blocks of one task's result
};

/// Tiles of `tile` pixels a side over a width x height film, centre first.
[[nodiscard]] std::vector<TileRect> cut_tiles(int width, int height, int tile);

/// The plan of one job. Invariants: the first block of all tiles comes before any second one; the
/// blocks of a pixel are handed out in order and a pass of a tile starts only when the one before is
/// merged; an item is merged at most once. The order of items depends on measured time, the set of
/// (pixel, block) pairs never does.
class TilePlan {
 public:
  /// `block_samples`: samples of each block, in order; at least one block.
  TilePlan(int width, int height, int tile, const std::vector<std::uint32_t>& block_samples,
           const TaskLength& length);

  /// Blocks from this index on are not handed out until a later call raises the limit. Must not fall
  /// below what has been handed out.
  void set_limit(std::size_t end_block);
  /// The same for each tile by itself: none goes beyond the last border of a block at or below its number of
  /// samples (one a tile, row by row from the top left), nor back behind what it has.
  void set_tile_limits(const std::vector<std::uint64_t>& samples);
  /// Each tile ends at the last border of a block at or below its number of samples (one a tile, row by
  /// row from the top left). Before the first next().
  void set_tile_samples(const std::vector<std::uint64_t>& samples);
  /// Each tile begins where so many samples (one number a tile, row by row from the top left) have been
  /// merged before: at the last border of a block at or below it. After set_tile_samples(), before the
  /// first next().
  void resume(const std::vector<std::uint64_t>& samples);
  /// First block that the tile that is furthest has not merged.
  [[nodiscard]] std::size_t furthest_block() const;
  /// No tile starts another pass; those that have begun are handed out to their end.
  void close();
  /// Nothing is in flight and nothing can be handed out: all is done, the limit is reached, or the plan
  /// is closed. Every tile is at the border of a block.
  [[nodiscard]] bool at_rest() const { return flights_.empty() && !has_work(); }
  [[nodiscard]] bool closed() const { return closed_; }
  /// Blocks that hold at least so many samples, all of them at most.
  [[nodiscard]] std::size_t blocks_for(std::uint64_t samples) const;
  [[nodiscard]] std::size_t limit() const { return limit_; }
  /// Samples a pixel in each tile, row by row from the top left; whole passes only.
  [[nodiscard]] std::vector<std::uint64_t> tile_samples() const;

  /// Next item, or nothing while all that is left is in flight.
  [[nodiscard]] std::optional<WorkItem> next();

  /// The result of this item is in the film. False, and nothing changes, when the item is not in
  /// flight (late, twice, or after abandon()). `seconds`: time that its rendering took.
  bool merged(const WorkItem& item, double seconds);

  /// The item came to nothing: it is handed out again, with attempt + 1, before anything else.
  bool failed(const WorkItem& item);

  /// Nothing is handed out or merged any more.
  void abandon();

  [[nodiscard]] bool in_flight(const WorkItem& item) const { return flights_.contains(item.id); }
  [[nodiscard]] std::size_t items_in_flight() const { return flights_.size(); }
  /// True when next() would give an item.
  [[nodiscard]] bool has_work() const { return !again_.empty() || !ready_.empty(); }
  /// Expected seconds of an item; 0 while unknown.
  [[nodiscard]] double expected_seconds(const WorkItem& item) const;
  [[nodiscard]] bool done() const { return tiles_done_ == static_cast<int>(tiles_.size()); }

  [[nodiscard]] int tiles() const { return static_cast<int>(tiles_.size()); }
  [[nodiscard]] int tiles_started() const { return tiles_started_; }
  [[nodiscard]] int tiles_done() const { return tiles_done_; }
  [[nodiscard]] std::uint64_t samples_done() const { return samples_done_; }
  [[nodiscard]] std::uint64_t samples_target() const { return samples_target_; }
  /// Mean seconds of one sample of one pixel on one worker; 0 while unknown.
  [[nodiscard]] double seconds_per_sample() const { return seconds_per_sample_; }

 private:
  struct Tile {
    TileRect rect;
    std::size_t next_block = 0;  ///< first block that is not merged
    std::size_t end_block = 0;   ///< end of the tile's blocks
    std::size_t limit = SIZE_MAX;  ///< see set_tile_limits()
    std::size_t pass_end = 0;    ///< end of the pass that is being handed out; next_block: none is
    int next_row = 0;            ///< first row of that pass not handed out
    int bands_in_flight = 0;
    double seconds_per_sample = 0.0;  ///< of the last item that held this tile; 0: unknown
  };
  [[nodiscard]] std::uint64_t samples_in(std::size_t first, std::size_t end) const {
    return samples_before_[end] - samples_before_[first];
  }
  [[nodiscard]] std::size_t blocks() const { return samples_before_.size() - 1; }
  [[nodiscard]] std::size_t blocks_within(std::uint64_t samples) const;
  [[nodiscard]] std::size_t end_of(const Tile& tile) const;
  [[nodiscard]] std::size_t row_major(const Tile& tile) const;
  [[nodiscard]] double cost_of_sample(const Tile& tile) const;
  [[nodiscard]] double part_seconds(const WorkItem& item, const WorkItem::Part& part) const;
  [[nodiscard]] std::size_t pick_pass_end(const Tile& tile) const;
  [[nodiscard]] int pick_rows(const Tile& tile) const;
  [[nodiscard]] bool has_room(const WorkItem& item, std::uint64_t held_pixels, const Tile& tile) const;
  void let_go_on();
  void open_pass(Tile& tile) const;
  void take_band(WorkItem& item);
  void end_band(const WorkItem::Part& part);
  void learn(const WorkItem& item, double seconds);

  std::vector<std::uint64_t> samples_before_;  ///< [b]: samples of all blocks before b
  TaskLength length_;
  int tile_side_, tiles_across_;
  std::size_t limit_ = 0;
  bool closed_ = false;
  std::vector<Tile> tiles_;
  std::set<std::pair<std::size_t, std::size_t>> ready_;  ///< (next block, tile) with rows to give
  std::vector<WorkItem> again_;
  std::map<std::uint64_t, WorkItem> flights_;
  std::uint64_t next_id_ = 1;
  int tiles_started_ = 0, tiles_done_ = 0;
  std::uint64_t samples_done_ = 0, samples_target_ = 0;
  double seconds_per_sample_ = 0.0;
};

}  // namespace raykiln::server
