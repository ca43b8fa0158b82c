#include "diagnostics.hpp"

#include <utility>

namespace raykiln::render::io {
namespace {

constexpr std::size_t kMaxMessageBytes = 400;

// Length of the well-formed UTF-8 sequence at the front of `s` (Unicode 15, table 3-7), or 0.
std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t n = lead >= 0xC2 && lead <= 0xDF   ? 2
                        : lead >= 0xE0 && lead <= 0xEF ? 3
                        : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                       : 0;
  if (n == 0 || s.size() < n) return 0;
  for (std::size_t i = 1; i < n; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xF0 && byte(1) < 0x90);
  const bool surrogate = lead == 0xED && byte(1) > 0x9F;
  const bool too_large = lead == 0xF4 && byte(1) > 0x8F;
  return overlong || surrogate || too_large ? 0 : n;
}

}  // namespace

std::string clean_text(std::string_view raw, std::size_t max_bytes) {
  std::string text;
  while (!raw.empty()) {
    const std::size_t n = utf8_length(raw);
    const auto lead = static_cast<unsigned char>(raw[0]);
    const bool printable = n > 0 && lead >= 0x20 && lead != 0x7F;
    const std::string_view piece = printable ? raw.substr(0, n) : std::string_view("?");
    if (text.size() + piece.size() > max_bytes) return text + "...";
    text += piece;
    raw.remove_prefix(n > 0 ? n : 1);
  }
  return text;
}

bool Diagnostics::fail(ImportErrorCode code, std::string_view message, std::string_view file,
                       std::string_view where, std::string_view remedy) {
  if (error_) return false;
  error_ = ImportError{code, clean_text(message, kMaxMessageBytes), clean_text(file),
                       clean_text(where), clean_text(remedy, kMaxMessageBytes)};
  return false;
}

void Diagnostics::warn(ImportWarningCode code, std::string_view message, std::string_view file,
                       std::string_view where, std::uint64_t count) {
  std::tuple key(code, clean_text(message, kMaxMessageBytes), clean_text(file));
  const auto found = index_.find(key);
  if (found != index_.end()) {
    warnings_[found->second].count += count;
    return;
  }
  if (warnings_.size() >= limits().max_warnings) {
    not_listed_ += count;
    return;
  }
  warnings_.push_back({code, std::get<1>(key), std::get<2>(key), clean_text(where), count});
  index_.emplace(std::move(key), warnings_.size() - 1);
}

bool Diagnostics::may_go_on() {
  if (!error_ && options_->stop.stop_requested()) {
    fail(ImportErrorCode::kStopped, "the import was stopped on request");
  }
  return !error_;
}

std::vector<ImportWarning> Diagnostics::take_warnings() {
  if (not_listed_ > 0) {
    warnings_.push_back({ImportWarningCode::kMoreWarnings,
                         "further warnings are not listed", "", "", not_listed_});
  }
  return std::move(warnings_);
}

std::string line_text(std::uint64_t line) { return "line " + std::to_string(line); }

std::string in_quotes(std::string_view raw) {
  std::string text(1, '\'');
  text.append(clean_text(raw, 80)).push_back('\'');
  return text;
}

}  // namespace raykiln::render::io
