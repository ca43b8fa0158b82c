// Files that are compiled into the daemon: the page, if it was built, and the contract.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace raykiln::server {

struct EmbeddedFile {
  std::string_view path;  ///< "openapi.yaml", "index.html", "main.js", ...
  const unsigned char* bytes = nullptr;
  std::size_t size = 0;
};

[[nodiscard]] std::vector<EmbeddedFile> embedded_files();

/// Digest of the sources and the compiler that pictures depend on: equal for programs that make equal pictures.
[[nodiscard]] std::string_view engine_digest();

}  // namespace raykiln::server
