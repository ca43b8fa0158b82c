// What continuous integration shows: annotations and a summary, within its limits.
#include <algorithm>

#include "../text_format.hpp"
#include "batch_result.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kMostAnnotations = 10;             ///< GitHub shows no more errors of a step
constexpr std::size_t kMostSummaryBytes = 900U * 1024U;  ///< GitHub takes 1 MiB

/// GitHub's escapes of a workflow command; properties have two more.
std::string command_text(const std::string& text, bool property) {
  std::string result;
  for (const char c : text) {
    if (c == '%') result += "%25";
    else if (c == '\r') result += "%0D";
    else if (c == '\n') result += "%0A";
    else if (property && c == ':') result += "%3A";
    else if (property && c == ',') result += "%2C";
    else result += c;
  }
  return result;
}

std::string cell(std::string text) {
  std::replace_if(text.begin(), text.end(), [](char c) { return c == '|' || c == '\n' || c == '<' || c == '>' || c == '`'; }, ' ');
  return text;
}

}  // namespace

std::string github_annotations(const BatchResult& result) {
  std::string text;
  std::size_t written = 0, unwritten = 0;
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    const PictureResult& r = result.pictures[i];
    if (outcome(r) == ExitCode::kOk) continue;
    // The last one is kept for saying how many more there are.
    if (written + 1 == kMostAnnotations) {
      ++unwritten;
      continue;
    }
    text += "::error title=" + command_text(result.plan.pictures[i].name, true) + "::" +
            command_text(verdict_line(r), false) + '\n';
    ++written;
  }
  if (unwritten > 0) text += "::error title=raykiln::" + std::to_string(unwritten) + " more; see the report\n";
  return text;
}

std::string step_summary(const BatchResult& result) {
  std::string text = "### " + cell(result.plan.name) + "\n\n" + summary(result) + "\n\n" +
                     "| picture | result | seconds | error |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    const PictureResult& r = result.pictures[i];
    const std::string row = "| " + result.plan.pictures[i].name + " | " + cell(verdict_line(r)) + " | " +
                            (r.reused ? "reused" : short_number(r.seconds)) + " | " +
                            (r.error_reached ? short_number(100.0 * *r.error_reached) + " %" : "") + " |\n";
    if (text.size() + row.size() > kMostSummaryBytes) break;
    text += row;
  }
  return text + '\n';
}

}  // namespace raykiln::server
