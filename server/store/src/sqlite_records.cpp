#include "sqlite_records.hpp"

#include <algorithm>
#include <charconv>

#include "raykiln/base/record.hpp"
#include "raykiln/base/wall_micros.hpp"

namespace raykiln::server {
namespace {

std::int64_t bounded(std::uint64_t value) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(value, INT64_MAX));
}

std::string encode_files(const std::vector<SceneFileEntry>& files) {
  RecordWriter record;
  for (const SceneFileEntry& file : files) {
    record.text("name", file.name);
    record.natural("bytes", file.bytes);
    record.text("sha256", file.sha256);
  }
  return record.str();
}

std::vector<SceneFileEntry> decode_files(const std::string& text) {
  std::vector<SceneFileEntry> files;
  const auto record = RecordReader::parse(text);
  if (!record) return files;
  const auto& names = record->list("name");
  const auto& sizes = record->list("bytes");
  const auto& digests = record->list("sha256");
  if (sizes.size() != names.size() || digests.size() != names.size()) return files;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::uint64_t bytes = 0;
    std::from_chars(sizes[i].data(), sizes[i].data() + sizes[i].size(), bytes);
    files.push_back({names[i], bytes, digests[i]});
  }
  return files;
}

constexpr const char* kSceneColumns = "SELECT id, kind, name, bytes, created, report, files FROM scenes ";
constexpr const char* kJobColumns =
    "SELECT id, state, revision, scene, created, updated, key, digest, content, sequence, result FROM jobs ";
constexpr const char* kFinal = "state IN ('completed', 'failed', 'cancelled')";

SceneRecord scene_of(SQLite::Statement& row) {
  SceneRecord scene;
  scene.id = row.getColumn(0).getString();
  scene.kind = scene_kind_named(row.getColumn(1).getString()).value_or(SceneKind::kFiles);
  scene.name = row.getColumn(2).getString();
  scene.bytes = static_cast<std::uint64_t>(row.getColumn(3).getInt64());
  scene.created = from_micros(row.getColumn(4).getInt64());
  scene.report = row.getColumn(5).getString();
  scene.files = decode_files(row.getColumn(6).getString());
  return scene;
}

JobRecord job_of(SQLite::Statement& row) {
  JobRecord job;
  job.id = row.getColumn(0).getString();
  job.state = job_state_named(row.getColumn(1).getString()).value_or(JobState::kFailed);
  job.revision = static_cast<std::uint64_t>(row.getColumn(2).getInt64());
  job.scene = row.getColumn(3).getString();
  job.created = from_micros(row.getColumn(4).getInt64());
  job.updated = from_micros(row.getColumn(5).getInt64());
  if (!row.getColumn(6).isNull()) job.idempotency_key = row.getColumn(6).getString();
  job.request_digest = row.getColumn(7).getString();
  job.content = row.getColumn(8).getString();
  job.sequence = static_cast<std::uint64_t>(row.getColumn(9).getInt64());
  job.result_digest = row.getColumn(10).getString();
  return job;
}

std::optional<JobRecord> one_job(SQLite::Statement& query) {
  if (!query.executeStep()) return std::nullopt;
  return job_of(query);
}

}  // namespace

void create_tables(SQLite::Database& db) {
  db.exec(
      "CREATE TABLE IF NOT EXISTS scenes (id TEXT PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL,"
      " bytes INTEGER NOT NULL, created INTEGER NOT NULL, report TEXT NOT NULL, files TEXT NOT NULL)");
  db.exec(
      "CREATE TABLE IF NOT EXISTS jobs (sequence INTEGER PRIMARY KEY AUTOINCREMENT,"
      " id TEXT NOT NULL UNIQUE, state TEXT NOT NULL, revision INTEGER NOT NULL, scene TEXT NOT NULL,"
      " created INTEGER NOT NULL, updated INTEGER NOT NULL, key TEXT UNIQUE, digest TEXT NOT NULL,"
      " content TEXT NOT NULL, result TEXT NOT NULL DEFAULT '')");
  db.exec("CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs (state, sequence)");
  db.exec("CREATE INDEX IF NOT EXISTS jobs_by_scene ON jobs (scene, sequence)");
  db.exec("CREATE INDEX IF NOT EXISTS jobs_by_result ON jobs (result, sequence)");
}

void upgrade_tables(SQLite::Database& db, int version) {
  if (version < 2) db.exec("ALTER TABLE jobs ADD COLUMN result TEXT NOT NULL DEFAULT ''");
}

void insert_scene(SQLite::Database& db, const SceneRecord& scene) {
  SQLite::Statement query(db,
                          "INSERT INTO scenes (id, kind, name, bytes, created, report, files)"
                          " VALUES (?, ?, ?, ?, ?, ?, ?)");
  query.bind(1, scene.id);
  query.bind(2, std::string(name(scene.kind)));
  query.bind(3, scene.name);
  query.bind(4, bounded(scene.bytes));
  query.bind(5, to_micros(scene.created));
  query.bind(6, scene.report);
  query.bind(7, encode_files(scene.files));
  query.exec();
}

std::optional<SceneRecord> find_scene(SQLite::Database& db, const std::string& id) {
  SQLite::Statement query(db, std::string(kSceneColumns) + "WHERE id = ?");
  query.bind(1, id);
  if (!query.executeStep()) return std::nullopt;
  return scene_of(query);
}

std::vector<SceneRecord> list_scenes(SQLite::Database& db, std::size_t offset, std::size_t limit) {
  SQLite::Statement query(db, std::string(kSceneColumns) +
                                  "ORDER BY created DESC, rowid DESC LIMIT ? OFFSET ?");
  query.bind(1, bounded(limit));
  query.bind(2, bounded(offset));
  std::vector<SceneRecord> scenes;
  while (query.executeStep()) scenes.push_back(scene_of(query));
  return scenes;
}

int erase_scene(SQLite::Database& db, const std::string& id) {
  SQLite::Statement query(db, "DELETE FROM scenes WHERE id = ?");
  query.bind(1, id);
  return query.exec();
}

void upsert_job(SQLite::Database& db, const JobRecord& job) {
  SQLite::Statement query(
      db,
      "INSERT INTO jobs (id, state, revision, scene, created, updated, key, digest, content, result)"
      " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET state = excluded.state,"
      " revision = excluded.revision, updated = excluded.updated, content = excluded.content,"
      " result = excluded.result");
  query.bind(1, job.id);
  query.bind(2, std::string(name(job.state)));
  query.bind(3, bounded(job.revision));
  query.bind(4, job.scene);
  query.bind(5, to_micros(job.created));
  query.bind(6, to_micros(job.updated));
  if (job.idempotency_key.empty()) {
    query.bind(7);
  } else {
    query.bind(7, job.idempotency_key);
  }
  query.bind(8, job.request_digest);
  query.bind(9, job.content);
  query.bind(10, job.result_digest);
  query.exec();
}

std::optional<JobRecord> find_job(SQLite::Database& db, const std::string& id) {
  SQLite::Statement query(db, std::string(kJobColumns) + "WHERE id = ?");
  query.bind(1, id);
  return one_job(query);
}

std::optional<JobRecord> find_job_with_key(SQLite::Database& db, const std::string& key) {
  SQLite::Statement query(db, std::string(kJobColumns) + "WHERE key = ?");
  query.bind(1, key);
  return one_job(query);
}

std::optional<JobRecord> find_job_with_result(SQLite::Database& db, const std::string& digest) {
  SQLite::Statement query(db, std::string(kJobColumns) +
                                  "WHERE result = ? AND state = 'completed' ORDER BY sequence DESC LIMIT 1");
  query.bind(1, digest);
  return one_job(query);
}

std::vector<JobRecord> list_jobs(SQLite::Database& db, const JobQuery& query) {
  std::string sql = std::string(kJobColumns) + "WHERE 1";
  if (query.before > 0) sql += " AND sequence < ?";
  if (!query.scene.empty()) sql += " AND scene = ?";
  for (std::size_t i = 0; i < query.states.size(); ++i) {
    sql += i == 0 ? " AND state IN (?" : ", ?";
  }
  if (!query.states.empty()) sql += ")";
  SQLite::Statement rows(db, sql + " ORDER BY sequence DESC LIMIT ?");
  int slot = 0;
  if (query.before > 0) rows.bind(++slot, bounded(query.before));
  if (!query.scene.empty()) rows.bind(++slot, query.scene);
  for (const JobState state : query.states) rows.bind(++slot, std::string(name(state)));
  rows.bind(++slot, bounded(query.limit));
  std::vector<JobRecord> jobs;
  while (rows.executeStep()) jobs.push_back(job_of(rows));
  return jobs;
}

std::vector<std::string> erase_old_jobs(SQLite::Database& db, std::size_t keep) {
  std::vector<std::string> ids;
  const std::string old = std::string("SELECT id FROM jobs WHERE ") + kFinal +
                          " ORDER BY sequence DESC LIMIT -1 OFFSET ?";
  SQLite::Statement query(db, old);
  query.bind(1, bounded(keep));
  while (query.executeStep()) ids.push_back(query.getColumn(0).getString());
  if (ids.empty()) return ids;
  SQLite::Transaction transaction(db);
  for (const std::string& id : ids) {
    SQLite::Statement erase(db, "DELETE FROM jobs WHERE id = ?");
    erase.bind(1, id);
    erase.exec();
  }
  transaction.commit();
  return ids;
}

}  // namespace raykiln::server
