#include "mtl_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include "line_reader.hpp"
#include "material_mapping.hpp"
#include "mtl_map.hpp"
#include "scene_file_names.hpp"
#include "text_numbers.hpp"

namespace raykiln::render::io {
namespace {

constexpr double kLargestWeight = 1e6;  // of a colour that should lie in [0, 1]

class MtlReader {
 public:
  MtlReader(const SceneFiles& files, SceneFile& file, const std::string& name,
            Diagnostics& diagnostics, SceneDraft& draft)
      : files_(files), diagnostics_(diagnostics), draft_(draft), lines_(file, name, diagnostics) {}

  bool read() {
    std::string_view text;
    while (lines_.next(text)) {
      if (!statement(text)) return false;
    }
    return !diagnostics_.failed() && store();
  }

 private:
  bool statement(std::string_view text) {
    const std::string_view word = take_word(text);
    if (word.empty() || word[0] == '#') return true;
    if (word == "newmtl") return start(trimmed(text));
    if (!current_) {
      return lines_.fail(ImportErrorCode::kSyntax,
                         in_quotes(word) + " comes before the first newmtl");
    }
    if (word == "Kd") return color(text, word, kLargestWeight, current_->kd);
    if (word == "Ks") return color(text, word, kLargestWeight, current_->ks);
    if (word == "Ke") return emission(text, word);
    if (word == "map_Kd") return map(text, PictureRole::kColour, base_);
    if (word == "map_Ke") return map(text, PictureRole::kEmission, emission_);
    if (word == "map_d") return map(text, PictureRole::kOpacity, alpha_);
    if (word == "Tf") return color(text, word, kLargestWeight, current_->tf);
    if (word == "Ns") return number(text, word, 0.0, kMaxExponent, current_->ns);
    if (word == "Ni") return refraction(text);
    if (word == "d" || word == "Tr") return opacity(text, word);
    if (word == "illum") return illumination(text);
    if (word == "Ka") return true;  // ambient light is what the paths compute
    return other(word);
  }

  bool other(std::string_view word) {
    if (word.starts_with("map_") || word == "bump" || word == "disp" || word == "decal" ||
        word == "refl" || word == "norm") {
      warn(ImportWarningCode::kIgnoredTexture,
           "textures of this kind are not supported yet: " + in_quotes(word) +
               " is ignored, factors are used");
      return true;
    }
    warn(ImportWarningCode::kUnknownStatement, "the statement " + in_quotes(word) + " is ignored");
    return true;
  }

  bool start(std::string_view raw) {
    if (!store()) return false;
    const std::string name = clean_text(raw, kMaxNameBytes);
    if (name.empty()) return lines_.fail(ImportErrorCode::kSyntax, "newmtl without a name");
    if (!draft_.materials.contains(name) &&
        draft_.materials.size() >= diagnostics_.limits().max_materials) {
      return lines_.fail(ImportErrorCode::kLimitExceeded, "too many materials");
    }
    current_.emplace();
    current_->name = name;
    base_ = emission_ = alpha_ = {};
    return true;
  }

  bool store() {
    if (!current_) return true;
    const std::uint32_t id = draft_.materials.intern(current_->name);
    if (!draft_.materials.defined[id]) {
      if (emission_.used() && !current_->ke) current_->ke = Rgbd(1.0);
      current_->masked = alpha_.used();
      if (base_.used() || emission_.used() || alpha_.used()) {
        MaterialTextures& used = draft_.textures.of_material(id);
        used.base = base_;
        used.emission = emission_;
        used.alpha = alpha_;
      }
      draft_.materials.materials[id] = to_material(*current_);
      draft_.materials.defined[id] = true;
    }
    current_.reset();
    return true;
  }

  bool number(std::string_view& text, std::string_view what, double least, double most,
              double& value) {
    const NumberStatus status = take_number(text, value);
    if (status == NumberStatus::kNotFinite) {
      return lines_.fail(ImportErrorCode::kNotFinite, in_quotes(what) + " is not finite");
    }
    if (status != NumberStatus::kOk) {
      return lines_.fail(ImportErrorCode::kSyntax,
                         in_quotes(what) + (status == NumberStatus::kMissing
                                             ? " has no number"
                                             : " has the number " + in_quotes(take_word(text)) +
                                                   " that cannot be read"));
    }
    if (value < least || value > most) {
      value = std::clamp(value, least, most);
      warn(ImportWarningCode::kClampedValue, in_quotes(what) + " was out of range and is clamped");
    }
    return true;
  }

  // One number stands for three equal ones.
  bool color(std::string_view text, std::string_view what, double most, Rgbd& value) {
    const std::string_view first = trimmed(text).substr(0, 8);
    if (first.starts_with("spectral") || first.starts_with("xyz")) {
      warn(ImportWarningCode::kIgnoredFeature,
           in_quotes(what) + " as a spectrum or XYZ is not supported, the default is used");
      return true;
    }
    Rgbd read(0.0);
    if (!number(text, what, 0.0, most, read.x)) return false;
    read.y = read.z = read.x;
    if (const std::string_view rest = trimmed(text); !rest.empty() && rest[0] != '#') {
      if (!number(text, what, 0.0, most, read.y)) return false;
      if (!number(text, what, 0.0, most, read.z)) return false;
    }
    value = read;
    return true;
  }

  bool emission(std::string_view text, std::string_view word) {
    Rgbd value = current_->ke.value_or(Rgbd(0.0));
    if (!color(text, word, diagnostics_.limits().max_radiance, value)) return false;
    current_->ke = value;
    return true;
  }

  bool map(std::string_view text, PictureRole role, TextureUse& use) {
    MtlMap map = read_mtl_map(text);
    if (map.file.empty()) return lines_.fail(ImportErrorCode::kSyntax, "the texture has no name");
    for (const std::string& option : map.ignored) {
      warn(ImportWarningCode::kIgnoredFeature,
           "the texture option " + in_quotes(option) + " is ignored");
    }
    const auto image = draft_.textures.beside(
        files_, map.file, {lines_.file_name(), line_text(lines_.line())}, role, diagnostics_);
    if (!image) return false;
    use = map.use;
    use.image = *image;
    return true;
  }

  bool refraction(std::string_view text) {
    double value = 0.0;
    if (!number(text, "Ni", 0.0, 1e6, value)) return false;
    if (value < 1e-3) {  // some exporters write 0 for "none"
      warn(ImportWarningCode::kClampedValue, "Ni below 0.001 is taken as absent");
    } else {
      current_->ni = value;
    }
    return true;
  }

  bool opacity(std::string_view text, std::string_view word) {
    std::string_view rest = text;
    if (take_word(rest) == "-halo") text = rest;
    double value = 0.0;
    if (!number(text, word, 0.0, 1.0, value)) return false;
    // d wins over Tr: exporters disagree on the direction of Tr.
    if (word == "d") {
      current_->opacity = value;
      opacity_owner_ = current_->name;
    } else if (opacity_owner_ != current_->name) {
      current_->opacity = 1.0 - value;
    }
    return true;
  }

  bool illumination(std::string_view text) {
    double value = 0.0;
    if (!number(text, "illum", 0.0, 10.0, value)) return false;
    current_->illum = static_cast<int>(value);
    return true;
  }

  void warn(ImportWarningCode code, const std::string& message) {
    diagnostics_.warn(code, message, lines_.file_name(), line_text(lines_.line()));
  }

  const SceneFiles& files_;
  Diagnostics& diagnostics_;
  SceneDraft& draft_;
  LineReader lines_;
  TextureUse base_, emission_, alpha_;  ///< of the current material
  std::optional<MtlMaterial> current_;
  std::string opacity_owner_;  ///< material whose d was read
};

}  // namespace

bool read_mtl(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
              SceneDraft& draft) {
  const auto file = open_limited(files, name, diagnostics.limits().max_mtl_bytes, diagnostics);
  return file != nullptr && MtlReader(files, *file, name, diagnostics, draft).read();
}

}  // namespace raykiln::render::io
