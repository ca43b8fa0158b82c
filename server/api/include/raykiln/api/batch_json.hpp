// Batches as JSON and back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "raykiln/api/problem.hpp"
#include "raykiln/base/config.hpp"
#include "raykiln/batches/batch.hpp"

namespace raykiln::server {

/// Body of POST /v1/batches, spread out: one item a picture. The problem lists every wrong field.
[[nodiscard]] std::variant<BatchRequest, Problem> parse_batch_request(std::string_view body, const JobLimits& limits);
/// One entry of `scenes` an item; parse_batch_request gives the same batch back.
[[nodiscard]] std::string batch_request_json(const BatchRequest& batch);

/// Schema Batch, on one line.
[[nodiscard]] std::string batch_json(const Batch& batch);
/// Batches without their items.
[[nodiscard]] std::string batch_page_json(const std::vector<Batch>& batches, const std::string& next_cursor);

/// What a client wants to know of a batch.
struct BatchItemView {
  std::string name, state, job;
  bool reused = false;
  std::string error;  ///< empty, or "code: detail (where)"
};
struct BatchView {
  std::string id, state;
  std::uint64_t revision = 0;
  std::vector<BatchItemView> items;
};
/// Nothing when the text is no batch.
[[nodiscard]] std::optional<BatchView> parse_batch_view(std::string_view text);

/// Body of POST /v1/missing-scenes and its answer.
[[nodiscard]] std::variant<std::vector<std::string>, Problem> parse_scene_ids(std::string_view body);
[[nodiscard]] std::string scene_ids_json(const char* field, const std::vector<std::string>& ids);
[[nodiscard]] std::optional<std::vector<std::string>> parse_missing_scenes(std::string_view text);

}  // namespace raykiln::server
