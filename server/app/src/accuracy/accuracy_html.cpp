#include "../batch/xml_text.hpp"
#include "../text_format.hpp"
#include "accuracy_report.hpp"

namespace raykiln::server {
namespace {

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; width: 100%; } th, td { text-align: left; padding: .25rem .75rem .25rem 0; }
tbody tr { border-top: 1px solid #8884; } td.n { font-variant-numeric: tabular-nums; white-space: nowrap; }
.biased { font-weight: 600; } svg { width: 100%; height: auto; } svg text { font-size: 12px; fill: currentColor; }
.grid path { stroke: #8883; fill: none; } .front { fill: none; stroke: #8886; stroke-width: 9; stroke-linejoin: round; }
</style>)";

std::string cell(const std::string& html, const char* kind = "n") {
  return std::string("<td class=\"") + kind + "\">" + html + "</td>";
}

std::string measured(double value, double ratio, const char* unit, double scale) {
  if (value < 0.0) return "not reached";
  return short_number(scale * value) + unit + " <small>(" + short_number(ratio) + "x)</small>";
}

std::string table_row(const KnobLine& line) {
  const render::VariantCurve& c = *line.curve;
  return "<tr><td><b>" + xml_text(c.variant.name) + "</b><br><small>" + xml_text(c.variant.what) + "</small></td>" +
         cell(measured(line.error, line.error_ratio, " %", 100.0)) +
         cell(measured(line.seconds, line.seconds_ratio, " s", 1.0)) +
         cell(bias_text(c.bias), c.bias.certain ? "n biased" : "n") +
         cell(short_number(100.0 * c.bias.brightness) + " % <small>+- " +
              short_number(100.0 * c.bias.brightness_error) + "</small>") + "</tr>\n";
}

}  // namespace

std::string accuracy_html(const AccuracyReport& report) {
  std::string rows;
  for (const KnobLine& line : knob_lines(report)) rows += table_row(line);
  const std::string title = "What accuracy costs: " + xml_text(report.scene);
  return "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width\"><title>" + title + "</title>" + kStyle + "</head><body><h1>" + title + "</h1><p>" +
         std::to_string(report.width) + " x " + std::to_string(report.height) +
         " pixels. Error is the root of relMSE against the reference; seconds are of one processor. The grey band joins the "
         "points that no other beats in both; errors above three times the worst of the defaults are not drawn.</p>" + accuracy_svg(report) +
         "<table><thead><tr><th>knob</th><th>error in " + short_number(report.seconds) + " s</th><th>seconds to " +
         short_number(100.0 * report.error) + " %</th><th>bias</th><th>brightness</th></tr></thead><tbody>\n" + rows +
         "</tbody></table><p>" + xml_text(reference_text(report)) +
         " Bias is what is left with any number of samples; \"none found\" means less than 3 standard errors.</p></body></html>\n";
}

}  // namespace raykiln::server
