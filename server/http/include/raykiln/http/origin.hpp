// Who may talk to the server: guards against DNS rebinding and writes from other sites' pages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "raykiln/http/head.hpp"

namespace raykiln::server {

/// Host names that are accepted beside `localhost` and IP literals. A rebinding attack needs a name
/// of the attacker's own, so that literals are safe. "*" accepts every name.
struct HostPolicy {
  std::vector<std::string> names;  ///< lower case
};

/// `host`: value of the Host header, with or without port.
[[nodiscard]] bool host_allowed(const HostPolicy& policy, std::string_view host);

/// True when a browser says that this request changes something on behalf of another origin's page.
[[nodiscard]] bool is_cross_origin_write(const RequestHead& head);

/// True for 127.0.0.0/8, ::1 and localhost.
[[nodiscard]] bool is_loopback(std::string_view address);

}  // namespace raykiln::server
