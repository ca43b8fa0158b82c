// An error as part of a record, under keys that begin with "error.".
#pragma once

#include "raykiln/base/record.hpp"
#include "raykiln/base/result.hpp"

namespace raykiln::server {

/// How long to wait before the next try is not kept: it is over when the record is read.
void write_error(RecordWriter& record, const Error& error);
/// Nothing when the record has none.
[[nodiscard]] std::optional<Error> read_error(const RecordReader& record);

}  // namespace raykiln::server
