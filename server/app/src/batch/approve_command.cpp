#include <algorithm>
#include <iostream>

#include "../input_file.hpp"
#include "../output_file.hpp"
#include "batch_result.hpp"
#include "raykiln/app/cli.hpp"
#include "value.hpp"

namespace raykiln::server {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 30U;
/// A report has a few kilobytes and a hundred values a picture.
constexpr DocumentBounds kReportBounds{std::size_t{16} << 20U, 400'000};

std::string text_of(const Value& map, const char* key) {
  const Value* value = map.find(key);
  return value != nullptr && value->is_text() && (value->quoted || value->text != "null") ? value->text : "";
}

/// False, and a message, when a file cannot be read or written.
bool replace_reference(const std::filesystem::path& picture, const std::filesystem::path& reference) {
  const auto bytes = read_whole_file(picture, kMostBytes);
  if (!bytes) {
    std::cerr << "raykiln: " << picture.string() << ": " << bytes.error().message << '\n';
    return false;
  }
  std::error_code ignored;  // writing says what is wrong
  if (reference.has_parent_path()) std::filesystem::create_directories(reference.parent_path(), ignored);
  const auto error = write_whole_file(reference, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (error) std::cerr << "raykiln: " << *error << '\n';
  return !error;
}

bool needs_approval(const Value& picture) {
  const std::string verdict = text_of(picture, "verdict");
  return verdict == "differs" || verdict == "no_reference";
}

/// A report comes from elsewhere: it may choose neither a file to read nor, but for a picture, one to write.
bool is_safe(const std::string& name, const std::filesystem::path& reference) {
  const auto kind = reference.extension();
  return name.find('/') == std::string::npos && (kind == ".exr" || kind == ".png");
}

}  // namespace

ExitCode approve_command(const CliOptions& options) {
  const auto& wanted = options.approve;
  const auto file = wanted.report / "results.json";
  const auto bytes = read_whole_file(file, kReportBounds.bytes);
  const auto results = bytes ? parse_yaml({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, kReportBounds)
                             : Result<Value>(bytes.error());
  const Value* pictures = results ? results->find("pictures") : nullptr;
  if (pictures == nullptr) {
    std::cerr << "raykiln: " << file.string() << ": no report of a batch\n";
    return ExitCode::kNotFound;
  }
  auto names = wanted.pictures;
  for (const Value& picture : pictures->list) {
    const std::string name = text_of(picture, "name"), reference = text_of(picture, "reference");
    const auto named = std::find(names.begin(), names.end(), name);
    const bool chosen = named != names.end();
    if (chosen) names.erase(named);
    if (!chosen && !(wanted.all && needs_approval(picture))) continue;
    if (reference.empty() || text_of(picture, "picture").empty()) {
      std::cerr << "raykiln: " << name << " has no picture or names no reference\n";
      return ExitCode::kNotFound;
    }
    if (!is_safe(name, reference)) {
      std::cerr << "raykiln: " << name << ": a reference must be an .exr or .png file, not " << reference << '\n';
      return ExitCode::kUsage;
    }
    if (!replace_reference(wanted.report / picture_file(name, ".exr"), reference)) return ExitCode::kFailure;
    std::cout << name << " -> " << reference << '\n';
  }
  for (const auto& name : names) std::cerr << "raykiln: the report has no picture " << name << '\n';
  return names.empty() ? ExitCode::kOk : ExitCode::kNotFound;
}

}  // namespace raykiln::server
