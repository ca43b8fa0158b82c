#include "raykiln/http/origin.hpp"

#include <algorithm>

namespace raykiln::server {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_ipv4(std::string_view text) {
  int parts = 0;
  while (true) {
    const auto dot = std::min(text.find('.'), text.size());
    const auto part = text.substr(0, dot);
    if (part.empty() || part.size() > 3 || !std::all_of(part.begin(), part.end(), is_digit)) {
      return false;
    }
    ++parts;
    if (dot == text.size()) return parts == 4;
    text.remove_prefix(dot + 1);
  }
}

bool is_ipv6(std::string_view text) {
  if (text.size() < 4 || text.front() != '[' || text.back() != ']') return false;
  const auto inner = text.substr(1, text.size() - 2);
  return std::all_of(inner.begin(), inner.end(), [](char c) {
    return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || c == ':' || c == '.';
  });
}

bool is_port(std::string_view text) {
  return text.empty() || (text.front() == ':' && text.size() <= 6 &&
                          std::all_of(text.begin() + 1, text.end(), is_digit));
}

/// Name without the port; empty when it is not a host.
std::string_view host_name(std::string_view host) {
  const auto bracket = host.rfind(']');
  const auto colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
  const auto end = std::min(colon, host.size());
  return is_port(host.substr(end)) ? host.substr(0, end) : std::string_view{};
}

}  // namespace

bool is_loopback(std::string_view address) {
  return address == "localhost" || address == "::1" || address == "[::1]" ||
         (is_ipv4(address) && address.starts_with("127."));
}

bool host_allowed(const HostPolicy& policy, std::string_view host) {
  const std::string name = lower(host_name(host));
  if (name.empty()) return false;
  if (name == "localhost" || is_ipv4(name) || is_ipv6(name)) return true;
  return std::any_of(policy.names.begin(), policy.names.end(),
                     [&](const std::string& known) { return known == "*" || known == name; });
}

bool is_cross_origin_write(const RequestHead& head) {
  if (head.method == "GET" || head.method == "HEAD") return false;
  if (const auto* site = head.header("sec-fetch-site")) {
    if (*site != "same-origin" && *site != "none") return true;
  }
  const auto* origin = head.header("origin");
  if (origin == nullptr) return false;
  const auto* host = head.header("host");
  if (host == nullptr) return true;
  return lower(*origin) != "http://" + lower(*host) && lower(*origin) != "https://" + lower(*host);
}

}  // namespace raykiln::server
