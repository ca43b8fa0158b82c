#include "raykiln/app/sse_reader.hpp"

#include <utility>

namespace raykiln::server {
namespace {

constexpr std::size_t kMaxBytes = 4U << 20U;

}  // namespace

std::optional<std::vector<SseEvent>> SseReader::feed(std::string_view bytes) {
  std::vector<SseEvent> done;
  while (true) {
    const auto end = bytes.find('\n');
    line_.append(bytes.substr(0, end));
    if (line_.size() + current_.data.size() > kMaxBytes) return std::nullopt;
    if (end == std::string_view::npos) return done;
    bytes.remove_prefix(end + 1);
    if (line_.ends_with('\r')) line_.pop_back();
    take_line(line_, done);
    line_.clear();
  }
}

void SseReader::take_line(std::string_view line, std::vector<SseEvent>& done) {
  if (line.empty()) {
    if (has_data_) done.push_back(std::exchange(current_, {}));
    current_ = {};
    has_data_ = false;
    return;
  }
  const auto colon = line.find(':');
  const auto field = line.substr(0, colon);
  auto value = colon == std::string_view::npos ? std::string_view{} : line.substr(colon + 1);
  if (value.starts_with(' ')) value.remove_prefix(1);
  if (field == "id") current_.id = value;
  if (field == "event") current_.event = value;
  if (field != "data") return;
  if (has_data_) current_.data.push_back('\n');
  current_.data.append(value);
  has_data_ = true;
}

}  // namespace raykiln::server
