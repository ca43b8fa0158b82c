// The route table of proto/openapi.yaml.
#pragma once

#include "raykiln/api/api.hpp"
#include "raykiln/api/batch_api.hpp"
#include "raykiln/http/router.hpp"
#include "raykiln/http/static_files.hpp"

namespace raykiln::server {

/// `api`, `batches` and `files` must outlive the table. `files` holds index.html and what it needs, and
/// openapi.yaml.
[[nodiscard]] Router make_routes(Api& api, BatchApi& batches, const StaticFiles& files,
                                 std::size_t max_json_bytes);

}  // namespace raykiln::server
