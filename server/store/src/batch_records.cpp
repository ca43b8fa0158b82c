#include "raykiln/store/batch_records.hpp"

#include "sqlite_guard.hpp"

namespace raykiln::server {
namespace {

constexpr int kPatienceMs = 5000;  ///< with the store's own connection

class SqliteBatches final : public BatchRecords {
 public:
  explicit SqliteBatches(const std::string& path) : db_(path, SQLite::OPEN_READWRITE, kPatienceMs) {
    db_.exec("PRAGMA synchronous = FULL");
    db_.exec(
        "CREATE TABLE IF NOT EXISTS batches (sequence INTEGER PRIMARY KEY AUTOINCREMENT,"
        " id TEXT NOT NULL UNIQUE, request TEXT NOT NULL, state TEXT NOT NULL)");
  }

  Status add(const BatchRecord& batch, const std::vector<std::string>& instead_of) override {
    return guarded([&]() -> Status {
      SQLite::Transaction whole(db_);
      for (const std::string& id : instead_of) run("DELETE FROM batches WHERE id = ?", {id});
      run("INSERT INTO batches (id, request, state) VALUES (?, ?, ?)", {batch.id, batch.request, batch.state});
      whole.commit();
      return success();
    });
  }
  Status set_state(const std::string& id, const std::string& state) override {
    return guarded([&]() -> Status {
      run("UPDATE batches SET state = ? WHERE id = ?", {state, id});
      return success();
    });
  }

  Result<std::vector<BatchRecord>> all() override {
    return guarded([&]() -> Result<std::vector<BatchRecord>> {
      SQLite::Statement rows(db_, "SELECT id, request, state FROM batches ORDER BY sequence");
      std::vector<BatchRecord> batches;
      while (rows.executeStep()) {
        batches.push_back({rows.getColumn(0).getString(), rows.getColumn(1).getString(), rows.getColumn(2).getString()});
      }
      return batches;
    });
  }

 private:
  void run(const char* sql, const std::vector<std::string>& values) {
    SQLite::Statement query(db_, sql);
    int slot = 0;
    for (const std::string& value : values) query.bind(++slot, value);
    query.exec();
  }

  SQLite::Database db_;
};

}  // namespace

Result<std::unique_ptr<BatchRecords>> BatchRecords::open(const StoreSettings& settings) {
  return guarded([&]() -> Result<std::unique_ptr<BatchRecords>> {
    return std::unique_ptr<BatchRecords>(std::make_unique<SqliteBatches>((settings.directory / "raykiln.db").string()));
  });
}

}  // namespace raykiln::server
