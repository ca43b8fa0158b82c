// The store in one directory: records in SQLite, bytes in files beside it.
#pragma once

#include <memory>

#include "raykiln/base/clock.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

/// Opens or creates the store, takes its lock ("store_locked", kConflict, while another process has
/// it), removes what a killed process left half done, and drops records whose bytes are torn.
[[nodiscard]] Result<std::unique_ptr<Store>> open_sqlite_store(const StoreSettings& settings,
                                                               const UploadLimits& limits, Log log);

}  // namespace raykiln::server
