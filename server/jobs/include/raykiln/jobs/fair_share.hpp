// Weighted fair choice between jobs (stride scheduling: Waldspurger & Weihl 1995).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace raykiln::server {

/// Over time each member gets worker seconds in proportion to its weight. A member that joins starts
/// at the present: it neither owes nor is owed anything.
class FairShare {
 public:
  /// `weight` > 0. Precondition: not a member.
  void join(const std::string& id, double weight);
  void leave(const std::string& id);

  /// The member that is furthest behind among those for which `has_work` is true.
  [[nodiscard]] std::optional<std::string> pick(
      const std::function<bool(const std::string&)>& has_work) const;

  /// `id` was given `seconds` of work (an estimate when it is handed out, corrected later; may be
  /// negative then).
  void charge(const std::string& id, double seconds);

 private:
  /// Worker seconds that a member without work for a while may catch up.
  static constexpr double kLargestCredit = 0.25;

  struct Member {
    double weight = 1.0;
    double pass = 0.0;  ///< seconds received / weight
  };
  std::map<std::string, Member> members_;
  double now_ = 0.0;  ///< pass of the member that was served last
};

}  // namespace raykiln::server
