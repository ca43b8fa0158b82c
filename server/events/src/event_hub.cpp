#include "raykiln/events/event_hub.hpp"

#include <map>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

namespace raykiln::server {
namespace {

/// One subscriber, guarded by the mutex of the hub.
struct Reader {
  SnapshotPtr newest;           ///< null: taken
  std::function<void()> wake;
  bool woken = false;           ///< since the last take()
};

struct Watched {
  SnapshotPtr newest;
  std::set<std::shared_ptr<Reader>> readers;
};

}  // namespace

struct EventHub::State {
  explicit State(std::size_t max) : max_clients(max) {}
  mutable std::mutex mutex;
  std::map<JobId, Watched> jobs;  ///< with at least one reader
  std::size_t clients = 0;
  const std::size_t max_clients;
};

namespace {

template <class State>
class HubSubscription final : public Subscription {
 public:
  HubSubscription(std::shared_ptr<State> state, JobId job, std::shared_ptr<Reader> reader, Seat seat)
      : state_(std::move(state)), job_(std::move(job)), reader_(std::move(reader)), seat_(seat) {}

  ~HubSubscription() override {
    std::function<void()> dropped;  // declared first: dies after the lock is released
    const std::scoped_lock lock(state_->mutex);
    dropped = std::move(reader_->wake);
    if (seat_ == Seat::kClient) --state_->clients;
    const auto found = state_->jobs.find(job_);
    if (found == state_->jobs.end()) return;
    found->second.readers.erase(reader_);
    if (found->second.readers.empty()) state_->jobs.erase(found);
  }

  SnapshotPtr take() override {
    const std::scoped_lock lock(state_->mutex);
    reader_->woken = false;
    return std::exchange(reader_->newest, nullptr);
  }

 private:
  std::shared_ptr<State> state_;
  JobId job_;
  std::shared_ptr<Reader> reader_;
  const Seat seat_;
};

}  // namespace

EventHub::EventHub(std::size_t max_clients) : state_(std::make_shared<State>(max_clients)) {}
EventHub::~EventHub() = default;

void EventHub::publish(SnapshotPtr snapshot) {
  std::vector<std::function<void()>> wakes;
  {
    const std::scoped_lock lock(state_->mutex);
    const auto found = state_->jobs.find(snapshot->id);
    if (found == state_->jobs.end()) return;
    Watched& watched = found->second;
    if (watched.newest->revision >= snapshot->revision) return;
    watched.newest = snapshot;
    for (const auto& reader : watched.readers) {
      reader->newest = snapshot;
      if (!std::exchange(reader->woken, true)) wakes.push_back(reader->wake);
    }
    // Nothing comes after a final state; the readers hold it themselves.
    if (is_final(snapshot->state)) state_->jobs.erase(found);
  }
  for (const auto& wake : wakes) wake();
}

Result<std::unique_ptr<Subscription>> EventHub::subscribe(SnapshotPtr current,
                                                          std::function<void()> wake, Seat seat) {
  const std::scoped_lock lock(state_->mutex);
  if (seat == Seat::kClient && state_->clients >= state_->max_clients) {
    return Error{ErrorKind::kUnavailable, "too_many_streams", "too many event streams are open", "", 5};
  }
  auto reader = std::make_shared<Reader>();
  reader->wake = std::move(wake);
  reader->newest = current;
  const JobId id = current->id;
  if (!is_final(current->state)) {
    Watched& watched = state_->jobs[id];
    if (!watched.newest || watched.newest->revision < current->revision) watched.newest = current;
    reader->newest = watched.newest;
    watched.readers.insert(reader);
  }
  if (seat == Seat::kClient) ++state_->clients;
  return std::unique_ptr<Subscription>(
      std::make_unique<HubSubscription<State>>(state_, id, std::move(reader), seat));
}

std::size_t EventHub::clients() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->clients;
}

}  // namespace raykiln::server
