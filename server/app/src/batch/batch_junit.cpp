#include "../one_line.hpp"
#include "../text_format.hpp"
#include "batch_result.hpp"
#include "xml_text.hpp"

namespace raykiln::server {
namespace {

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ").append(name).append("=\"").append(xml_text(value)).append("\"");
}

/// GitLab takes reports of 30 MB: a thousand pictures stay far below.
std::string message(const PictureResult& r) { return cut_to(verdict_line(r), 4096); }

std::string figures(const PictureResult& r) {
  std::string text;
  const auto line = [&text](const char* what, const std::string& value) {
    if (!value.empty()) text.append(what).append(" ").append(value).append("\n");
  };
  line("scene", r.scene);
  line("job", r.job);
  line("samples", r.samples > 0.0 ? short_number(r.samples) : "");
  line("error", r.error_reached ? short_number(100.0 * *r.error_reached) + " %" : "");
  if (r.reused) line("result", "reused");
  if (r.comparison) line("compared by", std::string(name(r.comparison->method)) + ": " + r.comparison->reason);
  return text;
}

std::string testcase(const BatchResult& result, std::size_t index) {
  const PictureResult& r = result.pictures[index];
  std::string text = "    <testcase" + attribute("classname", result.plan.name) +
                     attribute("name", result.plan.pictures[index].name) + attribute("time", json_number(r.seconds)) + ">\n";
  const auto child = [&](const char* tag, const char* type) {
    text.append("      <").append(tag).append(attribute("type", type)).append(attribute("message", message(r))).append("/>\n");
  };
  switch (outcome(r)) {
    case ExitCode::kJobFailed: child("error", "failed"); break;
    case ExitCode::kImageDiffers: child("failure", "differs"); break;
    case ExitCode::kLimitReached: child("failure", "limit_reached"); break;
    case ExitCode::kOk: break;
    default: text.append("      <skipped").append(attribute("message", message(r))).append("/>\n");
  }
  text.append("      <system-out>").append(xml_text(figures(r))).append("</system-out>\n");
  return text.append("    </testcase>\n");
}

}  // namespace

std::string junit_xml(const BatchResult& result) {
  std::size_t failures = 0, errors = 0, skipped = 0;
  std::string cases;
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    const ExitCode code = outcome(result.pictures[i]);
    if (code == ExitCode::kJobFailed) ++errors;
    else if (code == ExitCode::kImageDiffers || code == ExitCode::kLimitReached) ++failures;
    else if (code != ExitCode::kOk) ++skipped;
    cases += testcase(result, i);
  }
  const std::string counts = attribute("tests", std::to_string(result.pictures.size())) +
                             attribute("failures", std::to_string(failures)) +
                             attribute("errors", std::to_string(errors)) +
                             attribute("skipped", std::to_string(skipped)) +
                             attribute("time", json_number(result.seconds));
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite" +
         attribute("name", result.plan.name) + counts + ">\n" + cases + "  </testsuite>\n</testsuites>\n";
}

}  // namespace raykiln::server
