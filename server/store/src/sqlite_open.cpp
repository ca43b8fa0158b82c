// Opening a store: lock, schema, and the clean-up after a process that was killed.
#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <set>

#include "directory_store.hpp"
#include "image_file.hpp"
#include "raykiln/store/sqlite_store.hpp"
#include "sqlite_records.hpp"

namespace raykiln::server {
namespace {

Result<OwnedFd> take_lock(const std::filesystem::path& path) {
  OwnedFd fd(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!fd.is_open()) return disk_error("cannot open " + path.string(), errno);
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) {
    return Error{ErrorKind::kConflict, "store_locked", "another process uses this store",
                 path.string()};
  }
  return fd;
}

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(directory, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
    paths.push_back(it->path());
  }
  return paths;
}

bool is_whole(const std::filesystem::path& directory, const SceneRecord& scene) {
  for (std::size_t i = 0; i < scene.files.size(); ++i) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(directory / std::to_string(i), error);
    if (error || bytes != scene.files[i].bytes) return false;
  }
  return !scene.files.empty();
}

constexpr std::size_t kAll = INT64_MAX;

}  // namespace

void DirectoryStore::drop_torn_scenes() {
  for (const SceneRecord& scene : list_scenes(db_, 0, kAll)) {
    if (is_whole(paths_.scene(scene.id), scene)) {
      budget_->kept += scene.bytes;
      continue;
    }
    log_.warn("torn_scene_dropped", {{"scene", scene.id}});
    erase_scene(db_, scene.id);
    remove_quietly(paths_.scene(scene.id));
  }
}

void DirectoryStore::drop_unknown_files() {
  for (const auto& path : entries_of(paths_.staging())) remove_quietly(path);
  for (const auto& path : entries_of(paths_.scratch())) remove_quietly(path);
  for (const auto& path : entries_of(paths_.scenes())) {
    if (!find_scene(db_, path.filename().string())) remove_quietly(path);
  }
  for (const auto& path : entries_of(paths_.images())) {
    std::error_code error;
    if (!find_job(db_, path.filename().string())) {
      remove_quietly(path);
    } else if (const auto bytes = std::filesystem::file_size(path, error); !error) {
      budget_->kept += bytes;
    }
  }
}

void DirectoryStore::recover() {
  const std::scoped_lock lock(mutex_);
  drop_torn_scenes();
  drop_unknown_files();
}

Result<std::unique_ptr<Store>> open_sqlite_store(const StoreSettings& settings,
                                                 const UploadLimits& limits, Log log) {
  const StorePaths paths{settings.directory};
  for (const auto& path : {paths.root, paths.staging(), paths.scratch(), paths.scenes(),
                           paths.images()}) {
    if (auto made = make_directory(path); !made) return made.error();
  }
  auto lock = take_lock(paths.lock());
  if (!lock) return lock.error();
  try {
    auto store = std::make_unique<DirectoryStore>(paths, std::move(*lock), settings, limits, log);
    store->recover();
    return std::unique_ptr<Store>(std::move(store));
  } catch (const std::exception& fault) {
    return Error{ErrorKind::kInternal, "internal", fault.what(), paths.database().string()};
  }
}

}  // namespace raykiln::server
