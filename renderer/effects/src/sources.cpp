#include "sources.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace raykiln::render {
namespace {

template <class Number>
std::string digits_of(Number value) {
  std::array<char, 40> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

/// At most kMostOfName bytes of the name, cut between characters of UTF-8.
std::string quoted(const Material& material) {
  constexpr std::size_t kMostOfName = 60;
  std::size_t size = std::min(material.name.size(), kMostOfName);
  const auto inside = [&](std::size_t i) {
    return i < material.name.size() && (static_cast<unsigned char>(material.name[i]) & 0xC0U) == 0x80U;
  };
  while (size > 0 && inside(size)) --size;
  const char* more = size < material.name.size() ? "..." : "";
  return "material `" + material.name.substr(0, size) + more + "`: ";
}

}  // namespace

std::string shortest(double value) { return digits_of(value); }

std::string named(const Material& material) {
  const std::string text = quoted(material);
  return text.substr(0, text.size() - 2);
}

const Material* emitting_material(const EffectView& view) {
  return find_material(view, [](const Material& m) { return !is_black(m.emission); });
}

const Material* reflecting_material(const EffectView& view) {
  return find_material(view, is_reflecting);
}

bool has_light(const EffectView& view) {
  return !is_black(view.scene.background) || view.use.environment_shines ||
         emitting_material(view) != nullptr || view.use.lights_without_surface() > 0;
}

bool reaches_two_surfaces(const EffectView& view) {
  if (reflecting_material(view) == nullptr) return false;
  if (view.job.max_depth >= 1 && view.use.lights_without_surface() > 0) return true;
  return view.job.max_depth >= 2 &&
         (!is_black(view.scene.background) || view.use.environment_shines ||
          emitting_material(view) != nullptr);
}

Judgement of_lights(const EffectView& view, std::uint64_t count, const std::string& kind) {
  if (count == 0) return {false, "no " + kind + " has power above 0"};
  if (reflecting_material(view) == nullptr) return {false, "no surface reflects"};
  return {true, std::to_string(count) + ' ' + kind + (count == 1 ? "" : "s") +
                    " with power above 0"};
}

std::string says(const Material& material, const char* field, double value) {
  return quoted(material) + field + ' ' + digits_of(value);
}

std::string says(const Material& material, const char* field, const Rgb& value) {
  return quoted(material) + field + ' ' + text(value);
}

std::string text(const Rgb& value) {
  return digits_of(value.x) + ' ' + digits_of(value.y) + ' ' + digits_of(value.z);
}

Judgement of_surface(const EffectView& view, const Material* material, const std::string& evidence,
                     const char* otherwise) {
  if (!has_light(view)) return {false, "there is no light in the scene"};
  if (material == nullptr) return {false, otherwise};
  return {true, evidence};
}

}  // namespace raykiln::render
