#include "raykiln/base/record.hpp"

#include <charconv>

namespace raykiln::server {
namespace {

constexpr std::string_view kHead = "raykiln-record 1\n";

template <class Number>
std::string shown(Number value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

template <class Number>
Number read(const std::string& text, Number fallback) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? value : fallback;
}

std::optional<std::string> unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      out += text[i];
      continue;
    }
    if (++i == text.size()) return std::nullopt;
    if (text[i] != 'n' && text[i] != '\\') return std::nullopt;
    out += text[i] == 'n' ? '\n' : '\\';
  }
  return out;
}

}  // namespace

void RecordWriter::text(std::string_view key, std::string_view value) {
  if (text_.empty()) text_ = kHead;
  text_ += key;
  text_ += ' ';
  for (const char c : value) {
    if (c == '\n') {
      text_ += "\\n";
      continue;
    }
    if (c == '\\') text_ += '\\';
    text_ += c;
  }
  text_ += '\n';
}

void RecordWriter::integer(std::string_view key, std::int64_t value) { text(key, shown(value)); }
void RecordWriter::natural(std::string_view key, std::uint64_t value) { text(key, shown(value)); }
void RecordWriter::real(std::string_view key, double value) { text(key, shown(value)); }

std::optional<RecordReader> RecordReader::parse(std::string_view text) {
  if (!text.starts_with(kHead) || text.back() != '\n') return std::nullopt;
  RecordReader reader;
  for (text.remove_prefix(kHead.size()); !text.empty();) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    const std::size_t space = line.find(' ');
    if (space == std::string_view::npos || space == 0) return std::nullopt;
    auto value = unescaped(line.substr(space + 1));
    if (!value) return std::nullopt;
    reader.values_[std::string(line.substr(0, space))].push_back(std::move(*value));
    text.remove_prefix(end + 1);
  }
  return reader;
}

bool RecordReader::has(std::string_view key) const { return values_.contains(key); }

const std::vector<std::string>& RecordReader::list(std::string_view key) const {
  static const std::vector<std::string> kNone;
  const auto found = values_.find(key);
  return found == values_.end() ? kNone : found->second;
}

std::string RecordReader::text(std::string_view key, std::string_view fallback) const {
  const auto& values = list(key);
  return values.empty() ? std::string(fallback) : values.front();
}
std::int64_t RecordReader::integer(std::string_view key, std::int64_t fallback) const {
  return has(key) ? read(list(key).front(), fallback) : fallback;
}
std::uint64_t RecordReader::natural(std::string_view key, std::uint64_t fallback) const {
  return has(key) ? read(list(key).front(), fallback) : fallback;
}
double RecordReader::real(std::string_view key, double fallback) const {
  return has(key) ? read(list(key).front(), fallback) : fallback;
}

}  // namespace raykiln::server
