#include "raykiln/http/multipart.hpp"

#include <algorithm>
#include <utility>

namespace raykiln::server {
namespace {

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool equals_ignoring_case(std::string_view a, std::string_view lower) {
  return a.size() == lower.size() && std::equal(a.begin(), a.end(), lower.begin(), [](char x, char y) {
           return (x >= 'A' && x <= 'Z' ? static_cast<char>(x - 'A' + 'a') : x) == y;
         });
}

/// A quoted string with its backslash escapes, or a bare token up to ';'. Advances `text` past it.
std::optional<std::string> take_parameter_value(std::string_view& text) {
  std::string value;
  if (text.empty() || text.front() != '"') {
    const auto end = std::min(text.find(';'), text.size());
    value = trim(text.substr(0, end));
    text.remove_prefix(end);
    return value;
  }
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '"') {
      text.remove_prefix(i + 1);
      return value;
    }
    // Only \" and \\ are escapes here: browsers send other backslashes as they are.
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == '"' || text[i + 1] == '\\')) ++i;
    value.push_back(text[i]);
  }
  return std::nullopt;
}

/// Value of parameter `name` of a header value such as `form-data; name="a"; filename="b"`; nothing
/// if it is absent or comes twice.
std::optional<std::string> parameter(std::string_view header, std::string_view name) {
  std::optional<std::string> found;
  header.remove_prefix(std::min(header.find(';'), header.size()));
  while (!header.empty()) {
    header.remove_prefix(1);  // the semicolon
    const auto equals = header.find('=');
    if (equals == std::string_view::npos) return found;
    const auto key = trim(header.substr(0, equals));
    header.remove_prefix(equals + 1);
    header = header.substr(std::min(header.find_first_not_of(" \t"), header.size()));
    auto value = take_parameter_value(header);
    if (!value) return std::nullopt;
    if (equals_ignoring_case(key, name)) {
      if (found) return std::nullopt;
      found = std::move(value);
    }
    header.remove_prefix(std::min(header.find(';'), header.size()));
  }
  return found;
}

bool is_boundary_char(char c) {
  if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) return true;
  return std::string_view("'()+_,-./:=? ").find(c) != std::string_view::npos;  // RFC 2046, 5.1.1
}

}  // namespace

std::optional<std::string> multipart_boundary(std::string_view content_type) {
  const auto type = trim(content_type.substr(0, content_type.find(';')));
  if (!equals_ignoring_case(type, "multipart/form-data")) return std::nullopt;
  auto boundary = parameter(content_type, "boundary");
  if (!boundary || boundary->empty() || boundary->size() > 70 || boundary->back() == ' ') {
    return std::nullopt;
  }
  if (!std::all_of(boundary->begin(), boundary->end(), is_boundary_char)) return std::nullopt;
  return boundary;
}

std::optional<std::string> disposition_filename(std::string_view value) {
  if (!equals_ignoring_case(trim(value.substr(0, value.find(';'))), "form-data")) {
    return std::nullopt;
  }
  return parameter(value, "filename");
}

MultipartParser::MultipartParser(std::string boundary, MultipartSink sink)
    : delimiter_("\r\n--" + boundary),
      sink_(std::move(sink)),
      // The first delimiter may open the body without a line break before it.
      pending_("\r\n") {}

bool MultipartParser::feed(std::string_view bytes) {
  if (state_ == State::kFailed) return false;
  if (state_ == State::kEpilogue) return true;  // to be ignored, RFC 2046
  pending_.append(bytes);
  while (step()) {
  }
  pending_.erase(0, position_);
  position_ = 0;
  return state_ != State::kFailed;
}

bool MultipartParser::step() {
  switch (state_) {
    case State::kStart: return read_start();
    case State::kAfterDelimiter: return read_after_delimiter();
    case State::kPartHead: return read_part_head();
    case State::kPartBody: return read_part_body();
    case State::kEpilogue: position_ = pending_.size(); return false;
    case State::kFailed: return false;
  }
  return false;
}

bool MultipartParser::read_start() {
  // No preamble: nobody sends one in a form, and it could hide anything.
  const auto have = std::min(pending_.size(), delimiter_.size());
  if (pending_.compare(0, have, delimiter_, 0, have) != 0) {
    return fail("the body does not begin with the boundary");
  }
  if (have < delimiter_.size()) return false;
  position_ = delimiter_.size();
  state_ = State::kAfterDelimiter;
  return true;
}

bool MultipartParser::read_after_delimiter() {
  if (pending_.size() - position_ < 2) return false;
  const auto mark = std::string_view(pending_).substr(position_, 2);
  position_ += 2;
  if (mark == "--") {
    state_ = State::kEpilogue;
    return true;
  }
  if (mark != "\r\n") return fail("a boundary is followed by neither a line break nor --");
  if (++parts_ > kMaxParts) return fail("more than 256 parts");
  state_ = State::kPartHead;
  return true;
}

bool MultipartParser::read_part_head() {
  const auto rest = std::string_view(pending_).substr(position_);
  const auto end = rest.find("\r\n\r\n");
  if (std::min(end, rest.size()) > kMaxPartHeadBytes) return fail("head of a part over 4096 bytes");
  if (end == std::string_view::npos) return false;

  std::optional<std::string> filename;
  auto head = rest.substr(0, end + 2);
  while (!head.empty()) {
    const auto line = head.substr(0, head.find("\r\n"));
    head.remove_prefix(line.size() + 2);
    const auto colon = line.find(':');
    if (colon == std::string_view::npos) return fail("head line of a part without a colon");
    if (!equals_ignoring_case(line.substr(0, colon), "content-disposition")) continue;
    if (filename) return fail("a part with two Content-Dispositions");
    filename = disposition_filename(line.substr(colon + 1));
  }
  if (!filename) return fail("a part without a file name");
  position_ += end + 4;
  state_ = State::kPartBody;
  if (!sink_.begin(*filename)) {
    refused_ = true;
    return fail("refused");
  }
  return true;
}

bool MultipartParser::read_part_body() {
  const auto rest = std::string_view(pending_).substr(position_);
  const auto found = rest.find(delimiter_);
  if (found != std::string_view::npos) {
    if (!pass_on(rest.substr(0, found))) return false;
    position_ += found + delimiter_.size();
    state_ = State::kAfterDelimiter;
    if (sink_.end()) return true;
    refused_ = true;
    return fail("refused");
  }
  const auto keep = std::min(rest.size(), delimiter_.size() - 1);
  const auto ready = rest.size() - keep;
  if (ready > 0 && !pass_on(rest.substr(0, ready))) return false;
  position_ += ready;
  return false;
}

bool MultipartParser::pass_on(std::string_view bytes) {
  if (bytes.empty() || sink_.bytes(bytes)) return true;
  refused_ = true;
  return fail("refused");
}

bool MultipartParser::fail(std::string why) {
  state_ = State::kFailed;
  error_ = std::move(why);
  return false;
}

}  // namespace raykiln::server
