// Rows of the data base and records. SQLiteCpp throws; the caller turns that into values.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "raykiln/store/store.hpp"

namespace raykiln::server {

void create_tables(SQLite::Database& db);
/// Of a store that an older program wrote; then create_tables() adds what is missing.
void upgrade_tables(SQLite::Database& db, int version);
inline constexpr int kSchemaVersion = 2;

void insert_scene(SQLite::Database& db, const SceneRecord& scene);
[[nodiscard]] std::optional<SceneRecord> find_scene(SQLite::Database& db, const std::string& id);
[[nodiscard]] std::vector<SceneRecord> list_scenes(SQLite::Database& db, std::size_t offset,
                                                   std::size_t limit);
/// Number of rows removed.
int erase_scene(SQLite::Database& db, const std::string& id);

void upsert_job(SQLite::Database& db, const JobRecord& job);
[[nodiscard]] std::optional<JobRecord> find_job(SQLite::Database& db, const std::string& id);
[[nodiscard]] std::optional<JobRecord> find_job_with_key(SQLite::Database& db,
                                                         const std::string& key);
[[nodiscard]] std::optional<JobRecord> find_job_with_result(SQLite::Database& db,
                                                            const std::string& digest);
[[nodiscard]] std::vector<JobRecord> list_jobs(SQLite::Database& db, const JobQuery& query);
/// Removes the oldest finished jobs beyond `keep`; returns their ids.
std::vector<std::string> erase_old_jobs(SQLite::Database& db, std::size_t keep);

}  // namespace raykiln::server
