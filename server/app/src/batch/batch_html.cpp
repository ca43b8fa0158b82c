// The report: one page, everything in it, works from a file and without a network.
#include "../input_file.hpp"
#include "../text_format.hpp"
#include "batch_result.hpp"
#include "xml_text.hpp"

namespace raykiln::server {
namespace {

constexpr std::uint64_t kMostPngBytes = std::uint64_t{64} << 20U;

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<link rel="icon" href="data:,">
<style>
body{font:15px/1.4 system-ui,sans-serif;margin:1.5rem;background:#fff;color:#111}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(22rem,1fr));gap:1.2rem}
article{border:1px solid #bbb;border-radius:6px;padding:.7rem}
article:focus{outline:3px solid #36c}
article.bad{border-color:#b00020;border-width:2px}
h2{font-size:1rem;margin:.1rem 0}
img{width:100%;image-rendering:auto;background:#888;display:none}
img.shown{display:block}
button{font:inherit;margin:.3rem .3rem .3rem 0}
button[aria-pressed=true]{font-weight:bold;background:#111;color:#fff}
dl{display:grid;grid-template-columns:auto 1fr;gap:0 .8rem;margin:.4rem 0;font-size:.9em}
dd{margin:0;overflow-wrap:anywhere}
p.verdict{margin:.3rem 0}
</style>
)";

constexpr const char* kScript = R"(<script>
const show = (card, kind) => {
  if (!card.querySelector(`img[data-kind=${kind}]`)) return;
  for (const img of card.querySelectorAll('img')) img.classList.toggle('shown', img.dataset.kind === kind);
  for (const b of card.querySelectorAll('button')) b.setAttribute('aria-pressed', b.dataset.kind === kind);
};
const cards = [...document.querySelectorAll('article')];
for (const card of cards) {
  for (const b of card.querySelectorAll('button')) b.addEventListener('click', () => show(card, b.dataset.kind));
}
const keys = {1: 'render', 2: 'reference', 3: 'difference', 4: 'z'};
document.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const card = document.activeElement.closest('article');
  if (keys[event.key]) for (const one of card ? [card] : cards) show(one, keys[event.key]);
  if (event.key === 'f') for (const one of card ? [card] : cards) {
    const shown = one.querySelector('img.shown');
    if (shown) show(one, shown.dataset.kind === 'render' ? 'reference' : 'render');
  }
});
</script>
)";

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = (group << 8U) | (k < left ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= left ? kDigits[(group >> (18U - 6U * k)) & 63U] : '=');
  }
  return text;
}

struct Shown {
  const char *kind, *label, *ending;
};
constexpr Shown kShown[] = {{"render", "1 render", ".png"},
                            {"reference", "2 reference", ".reference.png"},
                            {"difference", "3 difference", ".difference.png"},
                            {"z", "4 z-map", ".z.png"}};

/// Buttons and pictures of those that are there.
std::string pictures(const std::string& name, const std::filesystem::path& folder) {
  std::string buttons, images;
  for (const Shown& one : kShown) {
    const auto bytes = read_whole_file(folder / picture_file(name, one.ending), kMostPngBytes);
    if (!bytes) continue;
    const bool first = images.empty();
    buttons.append("<button type=\"button\" data-kind=\"").append(one.kind).append("\" aria-pressed=\"");
    buttons.append(first ? "true" : "false").append("\">").append(one.label).append("</button>");
    images.append("<img data-kind=\"").append(one.kind).append(first ? "\" class=\"shown\"" : "\"");
    images.append(" alt=\"").append(one.label + 2).append(" of ").append(name);
    images.append("\" src=\"data:image/png;base64,").append(base64(*bytes)).append("\">");
  }
  return "<div>" + buttons + "</div>" + images;
}

std::string row(const char* term, const std::string& html) {
  return html.empty() ? "" : std::string("<dt>").append(term).append("</dt><dd>").append(html).append("</dd>");
}

std::string job_link(const BatchResult& result, const PictureResult& r) {
  if (r.job.empty() || result.server.empty()) return {};
  return "<a href=\"" + xml_text(result.server + "/jobs/" + r.job) + "\">" + xml_text(r.job) + "</a>";
}

std::string card(const BatchResult& result, std::size_t index, const std::filesystem::path& folder) {
  const PlannedPicture& planned = result.plan.pictures[index];
  const PictureResult& r = result.pictures[index];
  const bool bad = outcome(r) != ExitCode::kOk;
  std::string rows = row("state", std::string(name(r.state)) + (r.reused ? ", reused" : ""));
  rows += row("seconds", r.reused ? "" : short_number(r.seconds));
  rows += row("samples", r.samples > 0.0 ? short_number(r.samples) : "");
  rows += row("error", r.error_reached ? short_number(100.0 * *r.error_reached) + " %" : "");
  if (r.comparison && r.comparison->method != ComparisonMethod::kNone) {
    rows += row("judged by", r.comparison->method == ComparisonMethod::kNoise
                                 ? "noise"
                                 : "thresholds; noise was not taken into account");
  }
  rows += row("scene", xml_text(planned.scene.string()));
  rows += row("job", job_link(result, r));
  return "<article tabindex=\"0\"" + std::string(bad ? " class=\"bad\"" : "") + "><h2>" + xml_text(planned.name) +
         "</h2><p class=\"verdict\">" + xml_text(verdict_line(r)) + "</p>" +
         (r.state == PictureState::kCompleted ? pictures(planned.name, folder) : "") + "<dl>" + rows + "</dl></article>\n";
}

}  // namespace

std::string batch_html(const BatchResult& result, const std::filesystem::path& folder) {
  std::string html = kHead;
  html += "<title>" + xml_text(result.plan.name) + "</title></head><body><h1>" + xml_text(result.plan.name) + "</h1><p>" +
          xml_text(summary(result)) + ", " + short_number(result.seconds) +
          " s. Keys 1 to 4 show render, reference, difference and z-map of all pictures, or of the one with the focus; f flips "
          "between render and reference.</p><main>\n";
  // Those that need a look come first.
  for (const bool bad : {true, false}) {
    for (std::size_t i = 0; i < result.pictures.size(); ++i) {
      if ((outcome(result.pictures[i]) != ExitCode::kOk) == bad) html += card(result, i, folder);
    }
  }
  return html + "</main>" + kScript + "</body></html>\n";
}

}  // namespace raykiln::server
