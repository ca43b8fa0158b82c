// The events of one job for one client.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "raykiln/api/job_json.hpp"
#include "raykiln/api/message.hpp"
#include "raykiln/events/event_hub.hpp"
#include "wake_relay.hpp"

namespace raykiln::server {

class JobFeed final : public EventFeed {
 public:
  JobFeed(std::shared_ptr<WakeRelay> relay, std::unique_ptr<Subscription> subscription)
      : relay_(std::move(relay)), subscription_(std::move(subscription)) {}
  ~JobFeed() override { relay_->disconnect(); }
  JobFeed(const JobFeed&) = delete;
  JobFeed& operator=(const JobFeed&) = delete;

  void start(std::function<void()> wake) override { relay_->connect(std::move(wake)); }

  [[nodiscard]] FeedStep poll() override {
    const SnapshotPtr job = subscription_->take();
    if (!job) return {};
    return {"id: " + std::to_string(job->revision) + "\nevent: job\ndata: " + job_json(*job) + "\n\n",
            is_final(job->state)};
  }

 private:
  std::shared_ptr<WakeRelay> relay_;
  std::unique_ptr<Subscription> subscription_;
};

}  // namespace raykiln::server
