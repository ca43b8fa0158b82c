#include "raykiln/http/static_files.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "raykiln/api/etag.hpp"
#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kMaxFiles = 1000;
constexpr std::uintmax_t kMaxBytes = 64U << 20U;

}  // namespace

std::string_view media_type(std::string_view path) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kTypes{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".ico", "image/x-icon"},
      {".txt", "text/plain; charset=utf-8"},
      {".yaml", "application/yaml"},
      {".woff2", "font/woff2"},
  }};
  for (const auto& [ending, type] : kTypes) {
    if (path.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

void StaticFiles::add(std::string path, std::string bytes) {
  File file;
  file.type = media_type(path);
  file.etag = '"' + sha256_hex(bytes).substr(0, 32) + '"';
  file.bytes = std::make_shared<const std::string>(std::move(bytes));
  files_.insert_or_assign(std::move(path), std::move(file));
}

bool StaticFiles::add_directory(const std::filesystem::path& directory) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::uintmax_t total = 0;
  auto it = fs::recursive_directory_iterator(directory, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it->symlink_status(error).type() != fs::file_type::regular) continue;
    total += it->file_size(error);
    if (error || total > kMaxBytes || files_.size() >= kMaxFiles) return false;
    std::ifstream in(it->path(), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) return false;
    add(it->path().lexically_relative(directory).generic_string(), std::move(bytes));
  }
  return !error;
}

std::optional<Response> StaticFiles::get(std::string_view path,
                                         const std::string* if_none_match) const {
  const auto found = files_.find(path);
  if (found == files_.end()) return std::nullopt;
  const File& file = found->second;
  Response response;
  response.headers = {{"ETag", file.etag}, {"Cache-Control", "no-cache"}};
  if (if_none_match != nullptr && etag_matches(*if_none_match, file.etag)) {
    response.status = 304;
    return response;
  }
  response.content_type = file.type;
  response.body = file.bytes;
  return response;
}

}  // namespace raykiln::server
