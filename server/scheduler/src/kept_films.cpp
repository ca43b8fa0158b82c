#include "kept_films.hpp"

#include <algorithm>
#include <utility>

namespace raykiln::server {
namespace {

std::uint64_t bytes_of(const KeptFilm& kept) { return kept.job.statistics.film_bytes; }

}  // namespace

std::list<KeptFilm> KeptFilms::keep(KeptFilm film) {
  std::list<KeptFilm> gone;
  if (bytes_of(film) > max_bytes_) {
    gone.push_back(std::move(film));
    return gone;
  }
  bytes_ += bytes_of(film);
  films_.push_back(std::move(film));
  while (bytes_ > max_bytes_) {
    bytes_ -= bytes_of(films_.front());
    gone.splice(gone.end(), films_, films_.begin());
  }
  return gone;
}

std::optional<KeptFilm> KeptFilms::take(const JobId& job) {
  const auto found = std::find_if(films_.begin(), films_.end(),
                                  [&job](const KeptFilm& kept) { return kept.job.id == job; });
  if (found == films_.end()) return std::nullopt;
  KeptFilm taken = std::move(*found);
  films_.erase(found);
  bytes_ -= bytes_of(taken);
  return taken;
}

}  // namespace raykiln::server
