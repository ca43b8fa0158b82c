#include "scene_file_names.hpp"

#include <algorithm>
#include <vector>

namespace raykiln::render::io {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

// "a/./b/../c" -> "a/c"; nothing when it climbs above the top.
std::optional<std::string> resolve(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  std::vector<std::string_view> parts;
  std::string_view rest = path;
  while (!rest.empty()) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string_view part = rest.substr(0, slash);
    rest.remove_prefix(std::min(slash + 1, rest.size()));
    if (part.empty() || part == ".") continue;
    if (part != "..") {
      parts.push_back(part);
    } else if (parts.empty()) {
      return std::nullopt;
    } else {
      parts.pop_back();
    }
  }
  std::string joined;
  for (const std::string_view part : parts) {
    if (!joined.empty()) joined += '/';
    joined += part;
  }
  return joined;
}

// What is left and one byte more, to see the end; in blocks, so that a stop is noticed.
std::size_t block_for(std::uint64_t left) {
  return static_cast<std::size_t>(std::min<std::uint64_t>(kBlockBytes, left + 1));
}

}  // namespace

std::optional<std::string> find_beside(const SceneFiles& files, std::string_view from,
                                       std::string_view reference) {
  const bool absolute = reference.starts_with('/') || reference.starts_with('\\');
  if (absolute || reference.empty() || reference.size() > 1024) return std::nullopt;
  const auto path = resolve(std::string(folder_of(from)) + std::string(reference));
  if (!path || !is_safe_name(*path)) return std::nullopt;
  if (files.open(*path) != nullptr) return path;
  const std::string wanted = lower_case(*path);
  std::optional<std::string> found;
  for (const std::string& candidate : files.names()) {
    if (lower_case(candidate) != wanted) continue;
    if (found) return std::nullopt;  // two files: guessing would be worse than saying so
    found = candidate;
  }
  return found;
}

std::unique_ptr<SceneFile> open_limited(const SceneFiles& files, const std::string& name,
                                        std::uint64_t max_bytes, Diagnostics& diagnostics) {
  std::unique_ptr<SceneFile> file = files.open(name);
  if (file == nullptr) {
    diagnostics.fail(ImportErrorCode::kFileMissing, "there is no file " + in_quotes(name), name, "",
                     "add the file to the upload");
    return nullptr;
  }
  if (file->size() > max_bytes) {
    diagnostics.fail(ImportErrorCode::kFileTooLarge,
                     "the file has " + std::to_string(file->size()) + " bytes, the limit is " +
                         std::to_string(max_bytes),
                     name);
    return nullptr;
  }
  return file;
}

std::optional<std::string> read_whole(const SceneFiles& files, const std::string& name,
                                      std::uint64_t max_bytes, Diagnostics& diagnostics) {
  const auto file = open_limited(files, name, max_bytes, diagnostics);
  if (file == nullptr) return std::nullopt;
  std::string bytes;
  bytes.reserve(file->size() + 1);  // bounded by max_bytes, and a file's size is real
  while (true) {
    if (!diagnostics.may_go_on()) return std::nullopt;
    const std::size_t have = bytes.size();
    const std::size_t block = block_for(file->size() - std::min<std::uint64_t>(have, file->size()));
    bytes.resize(have + block);
    const auto got = file->read({bytes.data() + have, block});
    bytes.resize(have + got.value_or(0));
    if (!got || bytes.size() > max_bytes) {
      diagnostics.fail(got ? ImportErrorCode::kFileTooLarge : ImportErrorCode::kFileUnreadable,
                       got ? "the file grew while it was read" : "the file cannot be read", name);
      return std::nullopt;
    }
    if (*got == 0) return bytes;
  }
}

std::string extension_of(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || name.find('/', dot) != std::string_view::npos) return {};
  return lower_case(name.substr(dot + 1));
}

std::string_view folder_of(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string_view::npos ? std::string_view{} : name.substr(0, slash + 1);
}

}  // namespace raykiln::render::io
