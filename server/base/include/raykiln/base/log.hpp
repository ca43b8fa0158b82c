// Structured lines: time, level, module, event, then key=value. spdlog is used behind this header.
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace raykiln::server {

enum class LogLevel { kDebug, kInfo, kWarn, kError, kOff };

/// One key=value pair. A value with spaces, quotes or control characters is quoted and escaped, so
/// that hostile text (names from an upload) can never forge a line.
struct LogField {
  std::string_view key;
  std::string value;

  LogField(std::string_view k, std::string v) : key(k), value(std::move(v)) {}
  LogField(std::string_view k, std::string_view v) : key(k), value(v) {}
  LogField(std::string_view k, const char* v) : key(k), value(v) {}
  LogField(std::string_view k, double v);
  template <class Number>
    requires std::is_integral_v<Number>
  LogField(std::string_view k, Number v) : key(k), value(std::to_string(v)) {}
};

/// A cheap handle of one module's channel; copies share the sink. Safe to use from any thread.
class Log {
 public:
  /// A log that drops everything.
  Log();
  /// Lines at or above `level` to standard error.
  [[nodiscard]] static Log to_stderr(LogLevel level);
  /// The same sink under another module name.
  [[nodiscard]] Log channel(std::string_view module) const;

  void debug(std::string_view event, std::initializer_list<LogField> fields = {}) const;
  void info(std::string_view event, std::initializer_list<LogField> fields = {}) const;
  void warn(std::string_view event, std::initializer_list<LogField> fields = {}) const;
  void error(std::string_view event, std::initializer_list<LogField> fields = {}) const;

 private:
  struct Sink;
  void write(LogLevel level, std::string_view event, std::initializer_list<LogField> fields) const;
  std::shared_ptr<Sink> sink_;
  std::string module_;
};

/// The text of one line without time and level, for tests.
[[nodiscard]] std::string format_line(std::string_view module, std::string_view event,
                                      std::initializer_list<LogField> fields);

}  // namespace raykiln::server
