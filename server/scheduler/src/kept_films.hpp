// Films of jobs that have completed, so that others can go on from them.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "raykiln/image/film.hpp"
#include "raykiln/image/layers.hpp"
#include "raykiln/jobs/job_snapshot.hpp"

namespace raykiln::server {

/// A film at the borders of blocks, and what was measured on the way there.
struct KeptFilm {
  JobSnapshot job;  ///< as it ended
  std::shared_ptr<render::Film> film;
  std::vector<std::uint64_t> tile_samples;  ///< one a tile, row by row
  std::vector<float> pixel_seconds;
  std::shared_ptr<render::LayerFilm> layers;  ///< at the same borders; null for none
};

/// In memory only: after a restart, and when there is no room, a job that goes on begins anew, which
/// gives the same picture. Used by one thread.
class KeptFilms {
 public:
  explicit KeptFilms(std::uint64_t max_bytes) : max_bytes_(max_bytes) {}

  /// The oldest films make room, and are handed over with their memory; one that is larger than all of it is not kept.
  [[nodiscard]] std::list<KeptFilm> keep(KeptFilm film);
  /// Hands the film over, so that nobody else goes on from it.
  [[nodiscard]] std::optional<KeptFilm> take(const JobId& job);
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  std::uint64_t max_bytes_;
  std::uint64_t bytes_ = 0;
  std::list<KeptFilm> films_;  ///< the newest last
};

}  // namespace raykiln::server
