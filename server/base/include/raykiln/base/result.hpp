// Expected failures as values.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace raykiln::server {

/// What a caller can do about a failure; the API maps it to a status code.
enum class ErrorKind {
  kInvalid,      ///< the input is wrong: change it
  kUnsupported,  ///< the input is well formed but of a kind that is not handled
  kNotFound,
  kConflict,     ///< right in itself, but not in the present state
  kTooLarge,     ///< over a stated limit
  kTooMany,      ///< later: see retry_after_s
  kUnavailable,  ///< shutting down or not ready
  kStorageFull,
  kInternal,     ///< a fault of this program or its machine
};

struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string code;     ///< stable snake_case name, as listed in proto/openapi.yaml
  std::string message;  ///< for people, one sentence
  std::string where;    ///< JSON pointer, "file:line 12", a file name, or empty
  std::optional<int> retry_after_s{};
};

/// A value or the reason why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }

  /// Precondition: ok().
  [[nodiscard]] T& value() & { return std::get<0>(content_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(content_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(content_)); }
  T* operator->() { return &std::get<0>(content_); }
  const T* operator->() const { return &std::get<0>(content_); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }

  /// Precondition: !ok().
  [[nodiscard]] const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

/// Success without a value, or the reason of a failure.
using Status = Result<std::monostate>;
[[nodiscard]] inline Status success() { return std::monostate{}; }

}  // namespace raykiln::server
