#include "raykiln/http/response_text.hpp"

#include <array>

#include "raykiln/api/problem.hpp"
#include "raykiln/base/calendar.hpp"

namespace raykiln::server {
namespace {

// Only files of this server: no inline code, no other site, no framing.
constexpr std::string_view kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: "
    "data:; connect-src 'self'; font-src 'self'; manifest-src 'self'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'";

void add(std::string& text, std::string_view name, std::string_view value) {
  text.append(name).append(": ");
  for (const char c : value) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) text.push_back(c);
  }
  text.append("\r\n");
}

/// IMF-fixdate, RFC 9110, 5.6.7. The names are not those of the locale.
std::string http_date(std::chrono::system_clock::time_point now) {
  static constexpr std::array<const char*, 7> kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  static constexpr std::array<const char*, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                       "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const UtcTime utc(now);
  std::string text = kDays[utc.weekday.c_encoding()];
  text.append(", ").append(std::to_string(100 + static_cast<unsigned>(utc.date.day())), 1).append(" ");
  text.append(kMonths[static_cast<unsigned>(utc.date.month()) - 1]).append(" ");
  return text + std::to_string(static_cast<int>(utc.date.year())) + ' ' + utc.clock() + " GMT";
}

}  // namespace

std::string response_head(const Response& response, const ResponseFraming& framing) {
  std::string text = "HTTP/1.1 " + std::to_string(response.status) + ' ';
  text.append(reason_phrase(response.status)).append("\r\n");
  add(text, "Date", http_date(framing.now));
  for (const auto& [name, value] : response.headers) add(text, name, value);
  if (!response.content_type.empty()) add(text, "Content-Type", response.content_type);
  const bool has_no_body = response.status == 204 || response.status == 304;
  if (!framing.until_close && !has_no_body) {
    add(text, "Content-Length", std::to_string(response.body ? response.body->size() : 0));
  }
  if (!framing.keep_alive) add(text, "Connection", "close");
  else if (framing.http_1_0) add(text, "Connection", "keep-alive");
  add(text, "X-Request-Id", framing.request_id);
  add(text, "X-Content-Type-Options", "nosniff");
  add(text, "Cross-Origin-Resource-Policy", "same-origin");
  add(text, "Referrer-Policy", "no-referrer");
  if (response.content_type.starts_with("text/html")) {
    add(text, "Content-Security-Policy", kPagePolicy);
  }
  return text + "\r\n";
}

}  // namespace raykiln::server
