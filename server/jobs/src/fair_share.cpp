#include "raykiln/jobs/fair_share.hpp"

#include <algorithm>

namespace raykiln::server {

void FairShare::join(const std::string& id, double weight) {
  members_[id] = Member{weight, now_};
}

void FairShare::leave(const std::string& id) { members_.erase(id); }

std::optional<std::string> FairShare::pick(
    const std::function<bool(const std::string&)>& has_work) const {
  const std::pair<const std::string, Member>* best = nullptr;
  for (const auto& entry : members_) {
    if (best != nullptr && best->second.pass <= entry.second.pass) continue;
    if (has_work(entry.first)) best = &entry;
  }
  if (best == nullptr) return std::nullopt;
  return best->first;
}

void FairShare::charge(const std::string& id, double seconds) {
  const auto found = members_.find(id);
  if (found == members_.end()) return;
  Member& member = found->second;
  // Who had no work for a while is not owed that time: it continues from the present. A correction
  // (negative) is taken as it is.
  if (seconds > 0.0) {
    member.pass = std::max(member.pass, now_ - kLargestCredit / member.weight);
    now_ = std::max(now_, member.pass);
  }
  member.pass += seconds / member.weight;
}

}  // namespace raykiln::server
