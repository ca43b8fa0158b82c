#include "raykiln/jobs/tile_plan.hpp"

#include <algorithm>
#include <cmath>

namespace raykiln::server {
namespace {

/// Tiles that one item holds at most: bounds the memory of an item with tiles of few pixels.
constexpr std::size_t kMaxParts = 4096;

/// Squared distance from the centre of the film, times four, to stay in integers.
std::int64_t distance(const TileRect& r, int width, int height) {
  const std::int64_t dx = std::int64_t{r.x0} + r.x1 - width;
  const std::int64_t dy = std::int64_t{r.y0} + r.y1 - height;
  return dx * dx + dy * dy;
}

}  // namespace

std::vector<TileRect> cut_tiles(int width, int height, int tile) {
  std::vector<TileRect> tiles;
  for (int y = 0; y < height; y += tile) {
    for (int x = 0; x < width; x += tile) {
      tiles.push_back({x, y, std::min(x + tile, width), std::min(y + tile, height)});
    }
  }
  std::stable_sort(tiles.begin(), tiles.end(), [&](const TileRect& a, const TileRect& b) {
    return distance(a, width, height) < distance(b, width, height);
  });
  return tiles;
}

TilePlan::TilePlan(int width, int height, int tile, const std::vector<std::uint32_t>& block_samples,
                   const TaskLength& length)
    : samples_before_{0},
      length_(length),
      tile_side_(tile),
      tiles_across_((width + tile - 1) / tile),
      limit_(block_samples.size()) {
  for (const std::uint32_t samples : block_samples) {
    samples_before_.push_back(samples_before_.back() + samples);
  }
  for (const TileRect& rect : cut_tiles(width, height, tile)) {
    ready_.emplace(0, tiles_.size());
    Tile& added = tiles_.emplace_back();
    added.rect = rect;
    added.end_block = limit_;
  }
  samples_target_ = TileRect{0, 0, width, height}.pixels() * samples_before_.back();
}

std::size_t TilePlan::end_of(const Tile& tile) const {
  return std::min({tile.end_block, tile.limit, limit_});
}

std::size_t TilePlan::row_major(const Tile& tile) const {
  return static_cast<std::size_t>(tile.rect.y0 / tile_side_) * static_cast<std::size_t>(tiles_across_) +
         static_cast<std::size_t>(tile.rect.x0 / tile_side_);
}

std::size_t TilePlan::blocks_for(std::uint64_t samples) const {
  const auto enough = std::lower_bound(samples_before_.begin(), samples_before_.end(), samples);
  return std::min(static_cast<std::size_t>(enough - samples_before_.begin()), blocks());
}

void TilePlan::set_limit(std::size_t end_block) {
  limit_ = std::min(end_block, blocks());
  let_go_on();
}

void TilePlan::set_tile_limits(const std::vector<std::uint64_t>& samples) {
  for (Tile& tile : tiles_) {
    tile.limit = std::max({tile.next_block, tile.pass_end, blocks_within(samples.at(row_major(tile)))});
  }
  let_go_on();
}

/// Tiles that wait are ready when their limit is beyond what they have, and only then.
void TilePlan::let_go_on() {
  if (closed_) return;
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    const Tile& tile = tiles_[i];
    const bool parked = tile.bands_in_flight == 0 && tile.pass_end <= tile.next_block;
    if (parked && tile.next_block < end_of(tile)) ready_.emplace(tile.next_block, i);
    if (parked && tile.next_block >= end_of(tile)) ready_.erase({tile.next_block, i});
  }
}

/// Blocks that fit into so many samples.
std::size_t TilePlan::blocks_within(std::uint64_t samples) const {
  const auto above = std::upper_bound(samples_before_.begin(), samples_before_.end(), samples);
  return static_cast<std::size_t>(above - samples_before_.begin()) - 1;
}

void TilePlan::set_tile_samples(const std::vector<std::uint64_t>& samples) {
  samples_target_ = 0;
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    tile.end_block = blocks_within(samples.at(row_major(tile)));
    samples_target_ += tile.rect.pixels() * samples_before_[tile.end_block];
    if (tile.end_block > 0) continue;
    ready_.erase({0, i});
    ++tiles_done_;
  }
}

void TilePlan::resume(const std::vector<std::uint64_t>& samples) {
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    const std::size_t begin = std::min(blocks_within(samples.at(row_major(tile))), tile.end_block);
    if (begin == 0) continue;
    ready_.erase({0, i});
    tile.next_block = tile.pass_end = begin;
    ++tiles_started_;
    samples_done_ += tile.rect.pixels() * samples_before_[begin];
    if (begin == tile.end_block) ++tiles_done_;
    else if (begin < end_of(tile)) ready_.emplace(begin, i);
  }
}

std::size_t TilePlan::furthest_block() const {
  std::size_t furthest = 0;
  for (const Tile& tile : tiles_) furthest = std::max(furthest, tile.next_block);
  return furthest;
}

void TilePlan::close() {
  closed_ = true;
  std::erase_if(ready_, [this](const auto& entry) {
    Tile& tile = tiles_[entry.second];
    if (tile.pass_end > tile.next_block && tile.next_row > tile.rect.y0) return false;
    tile.pass_end = tile.next_block;  // opened, but nothing of it was handed out
    return true;
  });
}

std::vector<std::uint64_t> TilePlan::tile_samples() const {
  std::vector<std::uint64_t> samples(tiles_.size());
  for (const Tile& tile : tiles_) samples[row_major(tile)] = samples_before_[tile.next_block];
  return samples;
}

double TilePlan::cost_of_sample(const Tile& tile) const {
  return tile.seconds_per_sample > 0.0 ? tile.seconds_per_sample : seconds_per_sample_;
}

double TilePlan::part_seconds(const WorkItem& item, const WorkItem::Part& part) const {
  const auto samples = part.rect.pixels() * samples_in(item.first_block, item.end_block);
  return static_cast<double>(samples) * cost_of_sample(tiles_[part.tile]);
}

double TilePlan::expected_seconds(const WorkItem& item) const {
  double sum = 0.0;
  for (const WorkItem::Part& part : item.parts) sum += part_seconds(item, part);
  return sum;
}

std::size_t TilePlan::pick_pass_end(const Tile& tile) const {
  const std::size_t first = tile.next_block;
  std::size_t end = first + 1;
  const double cost = cost_of_sample(tile);
  // The first block of all tiles comes first, and as long as nothing is known, one at a time.
  if (first == 0 || cost <= 0.0) return end;
  const std::uint64_t pixels = tile.rect.pixels();
  while (end < end_of(tile) && pixels * (end + 1 - first) <= length_.max_pixel_blocks &&
         static_cast<double>(pixels * samples_in(first, end + 1)) * cost <=
             length_.target_seconds) {
    ++end;
  }
  return end;
}

int TilePlan::pick_rows(const Tile& tile) const {
  const int rows = tile.rect.y1 - tile.next_row;
  const auto width = static_cast<std::uint64_t>(tile.rect.x1 - tile.rect.x0);
  const std::uint64_t pixels = width * static_cast<std::uint64_t>(rows);
  const double cost = cost_of_sample(tile);
  std::uint64_t most = length_.max_pixel_blocks / (tile.pass_end - tile.next_block);
  if (cost <= 0.0) {
    // Nothing is known about the cost of a sample: as little as keeps streams long. The first
    // results set the pace, so that even costly scenes have few tasks that are too long.
    most = std::min(most, length_.least_stream);
  } else {
    const double one = cost * static_cast<double>(samples_in(tile.next_block, tile.pass_end));
    if (static_cast<double>(pixels) * one > length_.high_seconds) {
      // Bands of equal size, so that none is left over that is hardly worth its overhead.
      const double bands = std::ceil(static_cast<double>(pixels) * one / length_.target_seconds);
      const double share = std::ceil(static_cast<double>(pixels) / bands);
      const std::uint64_t samples = samples_in(tile.next_block, tile.pass_end);
      const std::uint64_t least = (length_.least_stream + samples - 1) / samples;
      most = std::min(most, std::max(least, static_cast<std::uint64_t>(share)));
    }
  }
  if (pixels <= most) return rows;
  return static_cast<int>(std::clamp<std::uint64_t>((most + width - 1) / width, 1,
                                                    static_cast<std::uint64_t>(rows)));
}

void TilePlan::open_pass(Tile& tile) const {
  if (tile.pass_end > tile.next_block) return;
  tile.pass_end = pick_pass_end(tile);
  tile.next_row = tile.rect.y0;
}

/// Hands out a band of the first ready tile.
void TilePlan::take_band(WorkItem& item) {
  const std::size_t index = ready_.begin()->second;
  Tile& tile = tiles_[index];
  const int rows = pick_rows(tile);
  TileRect band = tile.rect;
  band.y0 = tile.next_row;
  band.y1 = tile.next_row + rows;
  item.parts.push_back({index, band});
  tile.next_row = band.y1;
  ++tile.bands_in_flight;
  if (tile.next_row == tile.rect.y1) ready_.erase(ready_.begin());
}

/// Whether a whole further tile fits into the item.
bool TilePlan::has_room(const WorkItem& item, std::uint64_t held_pixels, const Tile& tile) const {
  if (tile.next_block != item.first_block || tile.pass_end != item.end_block) return false;
  if (tile.next_row != tile.rect.y0 || item.parts.size() >= kMaxParts) return false;
  const std::uint64_t pixels = held_pixels + tile.rect.pixels();
  const std::size_t blocks_held = item.end_block - item.first_block;
  if (pixels * blocks_held > length_.max_pixel_blocks) return false;
  const double cost = cost_of_sample(tile);
  if (cost <= 0.0) return pixels <= length_.least_stream;
  const auto samples = pixels * samples_in(item.first_block, item.end_block);
  return static_cast<double>(samples) * cost <= length_.target_seconds;
}

std::optional<WorkItem> TilePlan::next() {
  WorkItem item;
  if (!again_.empty()) {
    item = std::move(again_.back());
    again_.pop_back();
  } else {
    if (ready_.empty()) return std::nullopt;
    Tile& first = tiles_[ready_.begin()->second];
    open_pass(first);
    item.first_block = first.next_block;
    item.end_block = first.pass_end;
    take_band(item);
    for (std::uint64_t pixels = item.parts.back().rect.pixels(); !ready_.empty();) {
      Tile& more = tiles_[ready_.begin()->second];
      open_pass(more);
      if (!has_room(item, pixels, more)) break;
      take_band(item);
      pixels += item.parts.back().rect.pixels();
    }
  }
  item.id = next_id_++;
  flights_.emplace(item.id, item);
  return item;
}

void TilePlan::end_band(const WorkItem::Part& part) {
  Tile& tile = tiles_[part.tile];
  --tile.bands_in_flight;
  if (tile.bands_in_flight > 0 || tile.next_row < tile.rect.y1) return;
  if (tile.next_block == 0) ++tiles_started_;
  tile.next_block = tile.pass_end;
  if (tile.next_block == tile.end_block) {
    ++tiles_done_;
  } else if (!closed_ && tile.next_block < end_of(tile)) {
    ready_.emplace(tile.next_block, part.tile);
  }
}

void TilePlan::learn(const WorkItem& item, double seconds) {
  std::uint64_t pixels = 0;
  for (const WorkItem::Part& part : item.parts) pixels += part.rect.pixels();
  const auto samples = pixels * samples_in(item.first_block, item.end_block);
  if (!(seconds > 0.0) || samples == 0) return;
  const double measured = seconds / static_cast<double>(samples);
  for (const WorkItem::Part& part : item.parts) tiles_[part.tile].seconds_per_sample = measured;
  seconds_per_sample_ =
      seconds_per_sample_ > 0.0 ? 0.8 * seconds_per_sample_ + 0.2 * measured : measured;
}

bool TilePlan::merged(const WorkItem& item, double seconds) {
  const auto flight = flights_.find(item.id);
  if (flight == flights_.end()) return false;
  const WorkItem known = std::move(flight->second);
  flights_.erase(flight);
  learn(known, seconds);
  for (const WorkItem::Part& part : known.parts) {
    samples_done_ += part.rect.pixels() * samples_in(known.first_block, known.end_block);
    end_band(part);
  }
  return true;
}

bool TilePlan::failed(const WorkItem& item) {
  const auto flight = flights_.find(item.id);
  if (flight == flights_.end()) return false;
  WorkItem known = std::move(flight->second);
  flights_.erase(flight);
  ++known.attempt;
  again_.push_back(std::move(known));
  return true;
}

void TilePlan::abandon() {
  ready_.clear();
  again_.clear();
  flights_.clear();
}

}  // namespace raykiln::server
