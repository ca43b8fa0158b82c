#include <array>

#include "rows.hpp"

namespace raykiln::render {
namespace {

constexpr std::array<const EffectRow*, kEffects> kTable{
#define RAYKILN_EFFECT_ENTRY(code_name, name) &k##code_name##Row,
    RAYKILN_EFFECTS(RAYKILN_EFFECT_ENTRY)
#undef RAYKILN_EFFECT_ENTRY
};

}  // namespace

std::span<const EffectRow* const> effect_table() { return kTable; }

const EffectRow& row_of(Effect effect) { return *kTable[static_cast<std::size_t>(effect)]; }

std::string_view name(Grade grade) {
  switch (grade) {
    case Grade::kIdentical:
      return "identical";
    case Grade::kUnbiased:
      return "unbiased";
    case Grade::kBounded:
      return "bounded";
    case Grade::kUnbounded:
      break;
  }
  return "unbounded";
}

}  // namespace raykiln::render
