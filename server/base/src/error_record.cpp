#include "raykiln/base/error_record.hpp"

#include <algorithm>

namespace raykiln::server {

void write_error(RecordWriter& record, const Error& error) {
  record.integer("error.kind", static_cast<int>(error.kind));
  record.text("error.code", error.code);
  record.text("error.message", error.message);
  record.text("error.where", error.where);
}

std::optional<Error> read_error(const RecordReader& record) {
  if (!record.has("error.code")) return std::nullopt;
  const auto kind = std::clamp<std::int64_t>(record.integer("error.kind"), 0, static_cast<int>(ErrorKind::kInternal));
  return Error{static_cast<ErrorKind>(kind), record.text("error.code"), record.text("error.message"),
               record.text("error.where")};
}

}  // namespace raykiln::server
