// Faults of the database as values.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <string>

#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// Runs `step` and turns what SQLiteCpp throws into a value.
template <class Step>
auto guarded(const Step& step) -> decltype(step()) {
  try {
    return step();
  } catch (const SQLite::Exception& fault) {
    if (fault.getErrorCode() == SQLITE_FULL) {
      return Error{ErrorKind::kStorageFull, "storage_full", "the disk of the store is full", ""};
    }
    return Error{ErrorKind::kInternal, "internal", std::string("store: ") + fault.what(), ""};
  }
}

}  // namespace raykiln::server
