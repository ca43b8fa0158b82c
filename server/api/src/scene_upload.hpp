// An upload on its way into the store, and then through the scheduler's validation.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "raykiln/api/message.hpp"
#include "raykiln/scheduler/scheduler.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// One of the uploads that may be in progress at once.
class UploadSlot {
 public:
  /// Null when all are taken.
  [[nodiscard]] static std::unique_ptr<UploadSlot> take(std::shared_ptr<std::atomic<int>> count,
                                                        int most);
  ~UploadSlot();
  UploadSlot(const UploadSlot&) = delete;
  UploadSlot& operator=(const UploadSlot&) = delete;

 private:
  explicit UploadSlot(std::shared_ptr<std::atomic<int>> count) : count_(std::move(count)) {}
  std::shared_ptr<std::atomic<int>> count_;
};

class StagedUpload final : public Upload {
 public:
  StagedUpload(Scheduler& scheduler, std::unique_ptr<UploadSlot> slot,
               std::unique_ptr<SceneUpload> staged, AddSceneOptions options);

  [[nodiscard]] std::optional<Response> begin_file(const std::string& name) override;
  [[nodiscard]] std::optional<Response> write(std::span<const char> bytes) override;
  [[nodiscard]] std::optional<Response> end_file() override;
  [[nodiscard]] Response finish() override;

 private:
  Scheduler& scheduler_;
  std::unique_ptr<UploadSlot> slot_;
  std::unique_ptr<SceneUpload> staged_;
  AddSceneOptions options_;
};

}  // namespace raykiln::server
