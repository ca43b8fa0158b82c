#include "raykiln/store/batch_records.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

namespace raykiln::server {
namespace {

constexpr int kPatienceMs = 5000;  ///< with the store's own connection

Error error_of(const SQLite::Exception& fault) {
  if (fault.getErrorCode() == SQLITE_FULL) {
    return {ErrorKind::kStorageFull, "storage_full", "the disk of the store is full", ""};
  }
  return {ErrorKind::kInternal, "internal", std::string("store: ") + fault.what(), ""};
}

class SqliteBatches final : public BatchRecords {
 public:
  explicit SqliteBatches(const std::string& path) : db_(path, SQLite::OPEN_READWRITE, kPatienceMs) {
    db_.exec("PRAGMA synchronous = FULL");
    db_.exec(
        "CREATE TABLE IF NOT EXISTS batches (sequence INTEGER PRIMARY KEY AUTOINCREMENT,"
        " id TEXT NOT NULL UNIQUE, request TEXT NOT NULL, state TEXT NOT NULL)");
  }

  Status add(const BatchRecord& batch) override {
    return run("INSERT INTO batches (id, request, state) VALUES (?, ?, ?)", {batch.id, batch.request, batch.state});
  }
  Status set_state(const std::string& id, const std::string& state) override {
    return run("UPDATE batches SET state = ? WHERE id = ?", {state, id});
  }
  Status remove(const std::string& id) override { return run("DELETE FROM batches WHERE id = ?", {id}); }

  Result<std::vector<BatchRecord>> all() override {
    try {
      SQLite::Statement rows(db_, "SELECT id, request, state FROM batches ORDER BY sequence");
      std::vector<BatchRecord> batches;
      while (rows.executeStep()) {
        batches.push_back({rows.getColumn(0).getString(), rows.getColumn(1).getString(), rows.getColumn(2).getString()});
      }
      return batches;
    } catch (const SQLite::Exception& fault) {
      return error_of(fault);
    }
  }

 private:
  Status run(const char* sql, const std::vector<std::string>& values) {
    try {
      SQLite::Statement query(db_, sql);
      int slot = 0;
      for (const std::string& value : values) query.bind(++slot, value);
      query.exec();
      return success();
    } catch (const SQLite::Exception& fault) {
      return error_of(fault);
    }
  }

  SQLite::Database db_;
};

}  // namespace

Result<std::unique_ptr<BatchRecords>> BatchRecords::open(const StoreSettings& settings) {
  try {
    return std::unique_ptr<BatchRecords>(
        std::make_unique<SqliteBatches>((settings.directory / "raykiln.db").string()));
  } catch (const SQLite::Exception& fault) {
    return error_of(fault);
  }
}

}  // namespace raykiln::server
