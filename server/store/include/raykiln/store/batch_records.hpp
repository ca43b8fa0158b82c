// Batches that survive the process, as opaque texts.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raykiln/base/config.hpp"
#include "raykiln/base/result.hpp"

namespace raykiln::server {

struct BatchRecord {
  std::string id;
  std::string request;  ///< what was asked for: written once
  std::string state;    ///< how it stands: replaced with every change
};

/// A table beside those of the Store, in the same file, through a connection of its own. Every change is atomic
/// and on disk when the call returns. Errors: kInternal "internal", kStorageFull "storage_full". One thread at a time.
class BatchRecords {
 public:
  /// The store of the directory is open already, and keeps other processes out.
  [[nodiscard]] static Result<std::unique_ptr<BatchRecords>> open(const StoreSettings& settings);
  virtual ~BatchRecords() = default;

  /// Removes those and adds this one, or changes nothing.
  virtual Status add(const BatchRecord& batch, const std::vector<std::string>& instead_of) = 0;
  virtual Status set_state(const std::string& id, const std::string& state) = 0;
  /// Oldest first.
  virtual Result<std::vector<BatchRecord>> all() = 0;
};

}  // namespace raykiln::server
