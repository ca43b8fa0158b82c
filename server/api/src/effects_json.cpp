#include "effects_json.hpp"

#include "raykiln/api/effects_json.hpp"
#include "raykiln/effects/effect_choice.hpp"
#include "raykiln/effects/effect_row.hpp"

namespace raykiln::server {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* kForms = "must be auto, all or {\"without\": [names of effects]}";

std::string known_names() {
  std::string names;
  for (const render::EffectRow* row : render::effect_table()) {
    names += names.empty() ? "" : ", ";
    names += row->name;
  }
  return names;
}

/// The effects of the list; an error at each that is unknown or named before.
render::EffectSet read_names(const json& list, const std::string& pointer,
                             std::vector<FieldError>& errors) {
  render::EffectSet set;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto wrong = [&](const std::string& why) {
      if (errors.size() >= kMaxFieldErrors) return;
      errors.push_back({pointer + '/' + std::to_string(i), "invalid_value", why});
    };
    const auto effect =
        list[i].is_string() ? render::effect_named(list[i].get<std::string>()) : std::nullopt;
    if (!effect) wrong("must be one of " + known_names());
    else if (set.contains(*effect)) wrong("is named twice");
    else set.insert(*effect);
  }
  return set;
}

void read_without(const json& object, const std::string& pointer, std::vector<FieldError>& errors,
                  JobRequest& request) {
  FieldReader fields(object, pointer, errors);
  const json* list = fields.any("without", FieldReader::Need::kRequired);
  fields.finish();
  if (list == nullptr) return;
  if (!list->is_array() || list->empty() || list->size() > render::kEffects) {
    return fields.error("without", "wrong_type",
                        "must be a list of 1 to " + std::to_string(render::kEffects) +
                            " names out of " + known_names());
  }
  const auto without = read_names(*list, fields.pointer_to("without"), errors);
  request.effects = render::effect_choice_text({render::EffectChoice::Mode::kAuto, without});
}

}  // namespace

void read_effects(FieldReader& reader, std::vector<FieldError>& errors, JobRequest& request) {
  const json* value = reader.any("effects");
  if (value == nullptr) return;
  if (value->is_object()) return read_without(*value, reader.pointer_to("effects"), errors, request);
  if (!value->is_string()) return reader.error("effects", "wrong_type", kForms);
  if (*value != "auto" && *value != "all") return reader.error("effects", "invalid_value", kForms);
  request.effects = value->get<std::string>();
}

ordered_json effects_value(const std::string& effects) {
  const auto choice = render::effect_choice_of(effects);
  if (!choice || choice->without.empty()) return effects;
  auto names = ordered_json::array();
  for (const render::EffectRow* row : render::effect_table()) {
    if (choice->without.contains(row->effect)) names.push_back(row->name);
  }
  return {{"without", std::move(names)}};
}

ordered_json effect_report_value(const EffectReport& report) {
  if (report.lines.empty()) return nullptr;
  auto list = ordered_json::array();
  for (const EffectLine& line : report.lines) {
    list.push_back({{"effect", line.name},
                    {"called_for", line.called_for},
                    {"simulated", line.simulated},
                    {"evidence", line.evidence},
                    {"grade", line.grade},
                    {"left_out", line.left_out}});
  }
  return {{"label", report.label},
          {"approximation", is_approximation(report)},
          {"list", std::move(list)}};
}

std::string effect_report_json(const EffectReport& report) {
  return effect_report_value(report).dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace raykiln::server
