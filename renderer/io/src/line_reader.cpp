#include "line_reader.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace raykiln::render::io {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

bool is_comment(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first != std::string_view::npos && line[first] == '#';
}

// A comment ends with its line even when a path in it ends with a backslash.
bool continues(std::string_view line) {
  return !line.empty() && line.back() == '\\' && !is_comment(line);
}

}  // namespace

LineReader::LineReader(SceneFile& file, std::string name, Diagnostics& diagnostics)
    : file_(&file), name_(std::move(name)), diagnostics_(&diagnostics) {}

bool LineReader::fail(ImportErrorCode code, std::string_view message, std::string_view remedy) {
  return diagnostics_->fail(code, message, name_, line_text(first_line_), remedy);
}

bool LineReader::refill() {
  if (!diagnostics_->may_go_on()) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t max_line = diagnostics_->limits().max_line_bytes;
  if (end_ > max_line) {
    first_line_ = lines_read_ + 1;
    return fail(ImportErrorCode::kLineTooLong,
                "the line is longer than " + std::to_string(max_line) + " bytes",
                "check that this is a text file with line breaks");
  }
  const auto block =  // small files need small buffers; one byte more shows the end
      static_cast<std::size_t>(std::min<std::uint64_t>(kBlockBytes, file_->size() + 1));
  if (buffer_.size() < end_ + block) buffer_.resize(end_ + block);
  const auto got = file_->read({buffer_.data() + end_, buffer_.size() - end_});
  if (!got) {
    return diagnostics_->fail(ImportErrorCode::kFileUnreadable, "the file cannot be read", name_);
  }
  at_end_ = *got == 0;
  end_ += *got;
  return true;
}

bool LineReader::check_encoding() {
  started_ = true;
  const std::string_view start(buffer_.data() + begin_, end_ - begin_);
  if (start.starts_with("\xEF\xBB\xBF")) begin_ += 3;
  if (start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF")) {
    first_line_ = 1;
    return fail(ImportErrorCode::kUnsupportedEncoding, "the file is UTF-16 text",
                "save it as UTF-8 or plain ASCII");
  }
  return true;
}

bool LineReader::physical_line(std::string_view& line) {
  std::size_t searched = 0;
  while (true) {
    const char* start = buffer_.data() + begin_;
    const std::size_t left = end_ - begin_;
    const void* newline = left > searched ? std::memchr(start + searched, '\n', left - searched)
                                          : nullptr;
    if (newline != nullptr || (at_end_ && left > 0)) {
      const std::size_t length =
          newline != nullptr ? static_cast<std::size_t>(static_cast<const char*>(newline) - start)
                             : left;
      begin_ += newline != nullptr ? length + 1 : length;
      line = {start, length};
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      ++lines_read_;
      return true;
    }
    if (at_end_) return false;
    searched = left;
    if (!refill()) return false;
    if (!started_ && !check_encoding()) return false;
  }
}

bool LineReader::next(std::string_view& statement) {
  if (!physical_line(statement)) return false;
  first_line_ = lines_read_;
  if (!continues(statement)) return true;
  joined_.clear();
  while (continues(statement)) {
    statement.remove_suffix(1);
    joined_.append(statement).push_back(' ');
    if (joined_.size() > diagnostics_->limits().max_line_bytes) {
      return fail(ImportErrorCode::kLineTooLong, "the continued line is too long");
    }
    if (!physical_line(statement)) statement = {};
  }
  joined_ += statement;
  statement = joined_;
  return !diagnostics_->failed();
}

}  // namespace raykiln::render::io
