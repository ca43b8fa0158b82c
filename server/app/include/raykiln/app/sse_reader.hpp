// Server-sent events taken apart as their bytes arrive.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raykiln::server {

struct SseEvent {
  std::string id, event, data;
};

class SseReader {
 public:
  /// Events that are complete with these bytes. Nothing once a line or event is over 4 MiB.
  [[nodiscard]] std::optional<std::vector<SseEvent>> feed(std::string_view bytes);

 private:
  void take_line(std::string_view line, std::vector<SseEvent>& done);

  std::string line_;
  SseEvent current_;
  bool has_data_ = false;
};

}  // namespace raykiln::server
