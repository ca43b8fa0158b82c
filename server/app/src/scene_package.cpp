#include "raykiln/app/scene_package.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>

#include "raykiln/api/percent.hpp"
#include "raykiln/base/file_name.hpp"
#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxFiles = 256;
constexpr std::size_t kMaxNameBytes = 255;
constexpr std::uintmax_t kMaxGltfBytes = 256U << 20U;

/// File names after "mtllib" in an OBJ. A name may hold spaces, so that both readings are offered.
std::set<std::string> material_files(const fs::path& obj) {
  std::set<std::string> names;
  std::ifstream in(obj);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("mtllib")) continue;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    auto rest = line.substr(std::min<std::size_t>(line.find_first_not_of(" \t", 6), line.size()));
    names.insert(rest);
    for (std::size_t end = 0; !rest.empty(); rest.erase(0, end)) {
      rest.erase(0, std::min(rest.find_first_not_of(" \t"), rest.size()));
      end = std::min(rest.find_first_of(" \t"), rest.size());
      names.insert(rest.substr(0, end));
    }
  }
  return names;
}

/// File names in the texture statements of an MTL. Options stand before a name that may hold spaces: what
/// begins at any word is offered.
std::set<std::string> texture_files(const fs::path& mtl) {
  std::set<std::string> names;
  std::ifstream in(mtl);
  for (std::string line; std::getline(in, line);) {
    const auto begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos || line.compare(begin, 4, "map_") != 0) continue;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    std::replace(line.begin(), line.end(), '\\', '/');
    for (auto at = line.find_first_of(" \t", begin); at != std::string::npos; at = line.find_first_of(" \t", at)) {
      at = line.find_first_not_of(" \t", at);
      if (at != std::string::npos) names.insert(line.substr(at));
    }
  }
  return names;
}

/// Values of all members of this name in a JSON file. A scan, not a parse: a name too many is harmless,
/// since only files that exist are taken, and the importer judges what is missing.
std::set<std::string> values_of(const std::string& member, const fs::path& file) {
  std::set<std::string> names;
  std::error_code error;
  if (fs::file_size(file, error) > kMaxGltfBytes || error) return names;
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::string key = '"' + member + '"';
  for (auto at = text.find(key); at != std::string::npos; at = text.find(key, at + key.size())) {
    const auto open = text.find_first_not_of(" \t\r\n:", at + key.size());
    if (open == std::string::npos || text[open] != '"') continue;
    const auto close = text.find('"', open + 1);
    const auto uri = text.substr(open + 1, close == std::string::npos ? 0 : close - open - 1);
    if (uri.starts_with("data:")) continue;
    if (auto name = percent_decode(uri)) names.insert(*name);
  }
  return names;
}

void add_file(ScenePackage& package, const fs::path& root, const std::string& name) {
  std::error_code error;
  const fs::path path = root / name;
  if (!is_safe_file_name(name, kMaxNameBytes) || !fs::is_regular_file(path, error)) return;
  const auto bytes = fs::file_size(path, error);
  if (!error) package.files.push_back({name, path, bytes});
}

Result<ScenePackage> whole_folder(const fs::path& folder) {
  ScenePackage package;
  package.name = fs::absolute(folder).lexically_normal().filename().string();
  std::error_code error;
  auto it = fs::recursive_directory_iterator(folder, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it->symlink_status(error).type() != fs::file_type::regular) continue;
    add_file(package, folder, it->path().lexically_relative(folder).generic_string());
    if (package.files.size() > kMaxFiles) {
      return Error{ErrorKind::kTooLarge, "payload_too_large", "more than 256 files", folder.string()};
    }
  }
  if (package.files.empty()) {
    return Error{ErrorKind::kInvalid, "scene_unsupported", "no file in the folder", folder.string()};
  }
  return package;
}

Result<ScenePackage> file_with_neighbours(const fs::path& path, const std::set<std::string>& others) {
  ScenePackage package;
  const fs::path root = path.parent_path();
  package.name = path.filename().string();
  std::set<std::string> names = others;
  names.insert(package.name);
  names.insert("raykiln.json");
  names.merge(values_of("file", root / "raykiln.json"));  // of an environment
  for (const auto& name : names) add_file(package, root, name);
  return package;
}

Result<ScenePackage> one_file(const fs::path& path, SceneKind kind) {
  ScenePackage package{kind, path.filename().string(), {}};
  add_file(package, path.parent_path(), package.name);
  return package;
}

/// Digest of a file; adds its bytes to nothing else.
Result<std::string> file_digest(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  Sha256 hash;
  std::array<char, 64 * 1024> buffer{};
  while (in) {
    in.read(buffer.data(), buffer.size());
    hash.update(std::string_view(buffer.data(), static_cast<std::size_t>(in.gcount())));
  }
  if (!in.eof()) return Error{ErrorKind::kInternal, "internal", "cannot be read", path.string()};
  return to_hex(hash.finish());
}

}  // namespace

Result<ScenePackage> find_scene_files(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    auto package = whole_folder(path);
    if (package) {
      auto& files = package->files;
      std::sort(files.begin(), files.end(), [](auto& a, auto& b) { return a.name < b.name; });
    }
    return package;
  }
  if (!fs::is_regular_file(path, error)) {
    return Error{ErrorKind::kNotFound, "file_missing", "no such file or folder", path.string()};
  }
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (ending == ".zip") return one_file(path, SceneKind::kZip);
  if (ending == ".glb") return one_file(path, SceneKind::kGlb);
  if (ending == ".obj") {
    std::set<std::string> names = material_files(path);
    for (const std::string& mtl : material_files(path)) {
      const fs::path folder = fs::path(mtl).parent_path();
      for (const std::string& name : texture_files(path.parent_path() / mtl)) {
        names.insert((folder / name).lexically_normal().generic_string());
      }
    }
    return file_with_neighbours(path, names);
  }
  if (ending == ".gltf") return file_with_neighbours(path, values_of("uri", path));
  return Error{ErrorKind::kInvalid, "scene_unsupported",
               "a scene is a .obj, .gltf, .glb or .zip file or a folder", path.string()};
}

Result<std::string> scene_id(const ScenePackage& package) {
  if (package.kind != SceneKind::kFiles) return file_digest(package.files.front().path);
  Sha256 list;
  for (const auto& file : package.files) {
    const auto digest = file_digest(file.path);
    if (!digest) return digest.error();
    list.update(file.name);
    list.update(std::string_view("\0", 1));
    list.update(std::to_string(file.bytes));
    list.update(std::string_view("\0", 1));
    list.update(*digest);
    list.update(std::string_view("\n"));
  }
  return to_hex(list.finish());
}

}  // namespace raykiln::server
