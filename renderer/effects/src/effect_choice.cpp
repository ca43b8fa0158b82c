#include "raykiln/effects/effect_choice.hpp"

#include "raykiln/effects/effect_row.hpp"

namespace raykiln::render {
namespace {

constexpr std::string_view kWithout = "without=";

}  // namespace

std::string effect_choice_text(const EffectChoice& choice) {
  if (choice.mode == EffectChoice::Mode::kAll) return "all";
  if (choice.without.empty()) return "auto";
  std::string text(kWithout);
  for (const EffectRow* row : effect_table()) {
    if (!choice.without.contains(row->effect)) continue;
    if (text.size() > kWithout.size()) text += ',';
    text += row->name;
  }
  return text;
}

std::optional<EffectChoice> effect_choice_of(std::string_view text) {
  if (text == "auto") return EffectChoice{};
  if (text == "all") return EffectChoice{EffectChoice::Mode::kAll, {}};
  if (text.substr(0, kWithout.size()) != kWithout) return std::nullopt;
  text.remove_prefix(kWithout.size());
  EffectChoice choice;
  while (true) {
    const std::size_t comma = text.find(',');
    const auto effect = effect_named(text.substr(0, comma));
    if (!effect) return std::nullopt;
    choice.without.insert(*effect);
    if (comma == std::string_view::npos) return choice;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace raykiln::render
