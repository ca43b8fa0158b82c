#include "raykiln/http/head.hpp"

#include <algorithm>
#include <charconv>

namespace raykiln::server {
namespace {

HeadError bad(std::string detail) { return {400, "bad_request", std::move(detail)}; }

bool is_token_char(char c) {
  // RFC 9110, 5.6.2.
  if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) return true;
  return std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_token_char);
}

bool is_value_char(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte == '\t' || (byte >= 0x20 && byte != 0x7F);
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::optional<HeadError> read_request_line(std::string_view line, RequestHead& head) {
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || last == first) return bad("request line without three parts");
  const auto method = line.substr(0, first);
  const auto target = line.substr(first + 1, last - first - 1);
  const auto version = line.substr(last + 1);
  if (!is_token(method) || method.size() > 32) return bad("method is not a token");
  if (target.size() > kMaxTargetBytes) {
    return HeadError{414, "uri_too_long", "request target over 4096 bytes"};
  }
  const auto visible = [](char c) { return c > 0x20 && c < 0x7F; };
  if (target.empty() || !std::all_of(target.begin(), target.end(), visible)) {
    return bad("request target holds characters that must be percent-encoded");
  }
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    if (version.starts_with("HTTP/")) {
      return HeadError{505, "http_version_not_supported", "only HTTP/1.0 and HTTP/1.1"};
    }
    return bad("request line without a version");
  }
  head.method = method;
  head.target = target;
  head.http_1_0 = version == "HTTP/1.0";
  return std::nullopt;
}

std::optional<HeadError> read_field(std::string_view line, RequestHead& head) {
  if (line.front() == ' ' || line.front() == '\t') return bad("folded header line");
  const auto colon = line.find(':');
  if (colon == std::string_view::npos) return bad("header line without a colon");
  const auto name = line.substr(0, colon);
  const auto value = trim(line.substr(colon + 1));
  if (!is_token(name)) return bad("header name is not a token");
  if (!std::all_of(value.begin(), value.end(), is_value_char)) {
    return bad("control character in header " + lower(name));
  }
  if (head.headers.size() == kMaxHeaderFields) {
    return HeadError{431, "headers_too_large", "more than 100 header fields"};
  }
  head.headers.emplace_back(lower(name), std::string(value));
  return std::nullopt;
}

std::optional<HeadError> read_length(const std::string& value, RequestHead& head) {
  std::uint64_t length = 0;
  const auto* end = value.data() + value.size();
  const auto [stop, error] = std::from_chars(value.data(), end, length);
  if (error != std::errc{} || stop != end || value.size() > 18) {
    return bad("Content-Length is not one number");
  }
  head.content_length = length;
  return std::nullopt;
}

bool has_list_item(std::string_view list, std::string_view item) {
  while (!list.empty()) {
    const auto comma = std::min(list.find(','), list.size());
    if (lower(trim(list.substr(0, comma))) == item) return true;
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return false;
}

std::optional<HeadError> count_single_fields(const RequestHead& head) {
  for (const std::string_view name : {"host", "content-length", "transfer-encoding", "expect",
                                      "content-type", "origin", "sec-fetch-site",
                                      "idempotency-key", "last-event-id"}) {
    const auto times = std::count_if(head.headers.begin(), head.headers.end(),
                                     [&](const auto& field) { return field.first == name; });
    if (times > 1) return bad("repeated header " + std::string(name));
  }
  if (head.header("host") == nullptr && !head.http_1_0) return bad("no Host header");
  if (head.header("trailer") != nullptr) return bad("trailers are not taken");
  return std::nullopt;
}

std::optional<HeadError> interpret(RequestHead& head) {
  if (auto error = count_single_fields(head)) return error;
  if (const auto* coding = head.header("transfer-encoding")) {
    if (head.header("content-length") != nullptr) {
      return bad("both Content-Length and Transfer-Encoding");
    }
    if (head.http_1_0) return bad("Transfer-Encoding in HTTP/1.0");
    if (*coding != "chunked") return bad("Transfer-Encoding other than chunked");
    head.chunked = true;
  }
  if (const auto* length = head.header("content-length")) {
    if (auto error = read_length(*length, head)) return error;
  }
  if (const auto* expect = head.header("expect")) {
    if (lower(*expect) != "100-continue") {
      return HeadError{417, "expectation_failed", "only 100-continue can be expected"};
    }
    head.expect_continue = !head.http_1_0;
  }
  head.keep_alive = !head.http_1_0;
  for (const auto& [name, value] : head.headers) {
    if (name != "connection") continue;
    if (has_list_item(value, "close")) head.keep_alive = false;
    else if (head.http_1_0 && has_list_item(value, "keep-alive")) head.keep_alive = true;
  }
  return std::nullopt;
}

}  // namespace

const std::string* RequestHead::header(std::string_view lower_case_name) const {
  for (const auto& [name, value] : headers) {
    if (name == lower_case_name) return &value;
  }
  return nullptr;
}

std::size_t head_length(std::string_view bytes) {
  // A bare LF LF ends the head too, so that a peer that uses it gets its 400 now and not a timeout.
  const auto strict = bytes.find("\r\n\r\n");
  const auto loose = bytes.find("\n\n");
  if (strict != std::string_view::npos && strict < loose) return strict + 4;
  return loose == std::string_view::npos ? 0 : loose + 2;
}

std::variant<RequestHead, HeadError> parse_head(std::string_view bytes) {
  RequestHead head;
  if (bytes.size() > kMaxHeadBytes) {
    return HeadError{431, "headers_too_large", "header section over 16 KiB"};
  }
  bool first = true;
  while (!bytes.empty()) {
    const auto end = bytes.find("\r\n");
    if (end == std::string_view::npos) return bad("line that does not end with CR LF");
    const auto line = bytes.substr(0, end);
    bytes.remove_prefix(end + 2);
    if (line.find_first_of("\r\n") != std::string_view::npos) return bad("bare CR or LF");
    if (line.empty()) break;
    auto error = first ? read_request_line(line, head) : read_field(line, head);
    if (error) return *error;
    first = false;
  }
  if (first) return bad("no request line");
  if (auto error = interpret(head)) return *error;
  return head;
}

}  // namespace raykiln::server
