#include "obj_reader.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <vector>

#include "line_reader.hpp"
#include "mtl_reader.hpp"
#include "obj_faces.hpp"
#include "scene_file_names.hpp"
#include "text_numbers.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::size_t kMaxKindBytes = 80;  // of an unknown statement's first word
constexpr std::uint32_t kNoMaterial = 0xFFFFFFFFU, kNoObject = 0xFFFFFFFFU;

class ObjReader {
 public:
  ObjReader(const SceneFiles& files, SceneFile& file, const std::string& name,
            Diagnostics& diagnostics, SceneDraft& draft)
      : files_(files),
        name_(name),
        diagnostics_(diagnostics),
        draft_(draft),
        lines_(file, name, diagnostics),
        faces_(lines_, diagnostics, draft) {}

  bool read() {
    std::string_view text;
    while (lines_.next(text)) {
      if (!statement(text)) return false;
    }
    if (diagnostics_.failed() || !faces_.finish() || !read_libraries()) return false;
    report_skipped();
    report_unused();
    return true;
  }

 private:
  /// A kind of statement that is not read.
  struct Skipped {
    std::string word;
    std::uint64_t line;  ///< of the first one
    std::uint64_t count;
  };

  bool statement(std::string_view text) {
    const std::string_view word = take_word(text);
    if (word.empty() || word[0] == '#') return true;
    if (word == "v") return vertex(text);
    if (word == "f" || word == "fo") return face(text);
    if (word == "vn") return normal(text);
    if (word == "vt") return texture_coordinate(text);
    if (word == "g" || word == "o") return begin_object(text, word == "o");
    if (word == "s") return true;
    if (word == "usemtl") return use_material(text);
    if (word == "mtllib") return use_library(text);
    return other(word);
  }

  // Only counted here: a hostile file may hold half a billion of them.
  bool other(std::string_view word) {
    word = word.substr(0, kMaxKindBytes);
    for (Skipped& known : skipped_) {
      if (known.word != word) continue;
      ++known.count;
      return true;
    }
    const bool text_like = std::all_of(word.begin(), word.end(), [](char c) {
      return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F;
    });
    if (!text_like) {
      return lines_.fail(ImportErrorCode::kSyntax, "the line is not text",
                         "check that this is an OBJ file");
    }
    if (skipped_.size() < diagnostics_.limits().max_warnings) {
      skipped_.push_back({std::string(word), lines_.line(), 1});
    } else {
      ++more_skipped_;
    }
    return true;
  }

  void report_skipped() {
    for (const Skipped& kind : skipped_) {
      const bool element = kind.word == "l" || kind.word == "p";
      const std::string message =
          kind.word == "l"   ? "lines (l) have no surface and are ignored"
          : kind.word == "p" ? "points (p) have no surface and are ignored"
                             : "the statement " + in_quotes(kind.word) + " is ignored";
      diagnostics_.warn(
          element ? ImportWarningCode::kIgnoredElement : ImportWarningCode::kUnknownStatement,
          message, name_, line_text(kind.line), kind.count);
    }
    if (more_skipped_ > 0) {
      diagnostics_.warn(ImportWarningCode::kUnknownStatement,
                        "statements of further kinds are ignored", name_, "", more_skipped_);
    }
  }

  bool three_numbers(std::string_view& text, std::string_view what, Vec3d& v) {
    for (int axis = 0; axis < 3; ++axis) {
      const NumberStatus status = take_number(text, v[axis]);
      if (status == NumberStatus::kOk) continue;
      if (status == NumberStatus::kMissing) {
        return lines_.fail(ImportErrorCode::kSyntax,
                           "the " + std::string(what) + " has fewer than 3 numbers");
      }
      const std::string_view word = take_word(text);
      if (status == NumberStatus::kNotFinite) {
        return lines_.fail(ImportErrorCode::kNotFinite,
                           "the " + std::string(what) + " is not finite (" + in_quotes(word) + ")",
                           "remove NaN, infinite and overflowing numbers");
      }
      return lines_.fail(ImportErrorCode::kSyntax, "cannot read the number " + in_quotes(word));
    }
    return true;
  }

  bool vertex(std::string_view text) {
    Vec3d p;
    if (!three_numbers(text, "vertex", p)) return false;
    const double limit = diagnostics_.limits().max_coordinate;
    if (std::abs(p.x) > limit || std::abs(p.y) > limit || std::abs(p.z) > limit) {
      return lines_.fail(ImportErrorCode::kCoordinateTooLarge,
                         "a coordinate is larger than the limit of 1e" +
                             std::to_string(std::lround(std::log10(limit))),
                         "use a larger unit");
    }
    if (!room(draft_.positions.size(), "vertices")) return false;
    draft_.positions.push_back(p);
    has_extra_ = has_extra_ || !trimmed(text).empty();
    return true;
  }

  bool normal(std::string_view text) {
    Vec3d n;
    if (!three_numbers(text, "normal", n)) return false;
    if (!room(draft_.normals.size(), "normals")) return false;
    const double longest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (longest > 0.0) n = normalize(n / longest);  // by parts: the square may overflow
    draft_.normals.emplace_back(n);
    return true;
  }

  // v counts upwards in the file and downwards in a scene. What is not finite is left to the look-up,
  // which takes it as 0; a second number may be missing.
  bool texture_coordinate(std::string_view text) {
    double u = 0.0, v = 0.0;
    if (take_number(text, u) == NumberStatus::kOk) {
      if (take_number(text, v) != NumberStatus::kOk) v = 0.0;
    }
    std::vector<Vec2f>& coordinates = draft_.textures.uv_sets[0].coordinates;
    if (!room(coordinates.size(), "texture coordinates")) return false;
    constexpr double kMost = 1e30;
    coordinates.emplace_back(std::clamp(u, -kMost, kMost), std::clamp(1.0 - v, -kMost, kMost));
    return true;
  }

  bool room(std::size_t have, std::string_view what) {
    const std::uint64_t limit = diagnostics_.limits().max_vertices;
    if (have < limit) return true;
    return lines_.fail(ImportErrorCode::kLimitExceeded,
                       "more than " + std::to_string(limit) + " " + std::string(what));
  }

  bool face(std::string_view text) {
    if (material_ == kNoMaterial) material_ = draft_.materials.intern(kDefaultMaterialName);
    if (object_ == kNoObject) object_ = known_object();
    return faces_.add(text, material_, object_);
  }

  // Groups count as objects where nothing else is said: in files that have no `o` before them.
  bool begin_object(std::string_view text, bool is_object) {
    if (!is_object && has_objects_) return true;
    has_objects_ = has_objects_ || is_object;
    object_name_ = clean_text(trimmed(text), kMaxNameBytes);
    object_ = kNoObject;  // until there is a face: names alone take no memory
    return true;
  }

  // A name that comes again goes on with its object.
  std::uint32_t known_object() {
    const auto known = object_by_name_.find(object_name_);
    if (known != object_by_name_.end()) return known->second;
    const std::uint32_t added = draft_.add_object(object_name_);
    if (object_by_name_.size() < kMostObjects) object_by_name_.emplace(object_name_, added);
    return added;
  }

  bool use_material(std::string_view text) {
    const std::string material = clean_text(trimmed(text), kMaxNameBytes);
    if (material.empty()) {
      material_ = kNoMaterial;
      warn(ImportWarningCode::kUnknownMaterial, "usemtl without a name: the default is used");
      return true;
    }
    if (!draft_.materials.contains(material) &&
        draft_.materials.size() >= diagnostics_.limits().max_materials) {
      return lines_.fail(ImportErrorCode::kLimitExceeded, "too many materials");
    }
    material_ = draft_.materials.intern(material);
    return true;
  }

  bool use_library(std::string_view text) {
    if (++library_statements_ > diagnostics_.limits().max_mtl_files) {
      return lines_.fail(ImportErrorCode::kLimitExceeded, "too many mtllib statements");
    }
    const std::string_view wanted = trimmed(text);
    if (const auto whole = find_beside(files_, name_, wanted)) return add_library(*whole);
    while (true) {  // several names in one statement
      const std::string_view word = take_word(text);
      if (word.empty()) return true;
      if (const auto found = find_beside(files_, name_, word)) {
        if (!add_library(*found)) return false;
      } else {
        warn(ImportWarningCode::kMissingMaterialFile,
             "the material file " + in_quotes(wanted) + " is not part of the upload");
        return true;
      }
    }
  }

  bool add_library(const std::string& library) {
    if (std::find(libraries_.begin(), libraries_.end(), library) != libraries_.end()) return true;
    libraries_.push_back(library);
    return true;
  }

  bool read_libraries() {
    for (const std::string& library : libraries_) {
      if (!read_mtl(files_, library, diagnostics_, draft_)) return false;
    }
    return true;
  }

  void report_unused() {
    if (!has_extra_) return;
    diagnostics_.warn(ImportWarningCode::kIgnoredFeature,
                      "vertex weights and vertex colours are ignored", name_);
  }

  void warn(ImportWarningCode code, const std::string& message) {
    diagnostics_.warn(code, message, name_, line_text(lines_.line()));
  }

  const SceneFiles& files_;
  std::string name_;
  Diagnostics& diagnostics_;
  SceneDraft& draft_;
  LineReader lines_;
  ObjFaces faces_;
  std::uint32_t material_ = kNoMaterial;
  std::uint32_t object_ = kNoObject;
  std::string object_name_;
  bool has_objects_ = false;
  std::map<std::string, std::uint32_t, std::less<>> object_by_name_;
  std::vector<std::string> libraries_;
  std::size_t library_statements_ = 0;
  std::vector<Skipped> skipped_;
  std::uint64_t more_skipped_ = 0;
  bool has_extra_ = false;
};

}  // namespace

bool read_obj(const SceneFiles& files, const std::string& name, Diagnostics& diagnostics,
              SceneDraft& draft) {
  const auto file = open_limited(files, name, diagnostics.limits().max_file_bytes, diagnostics);
  return file != nullptr && ObjReader(files, *file, name, diagnostics, draft).read();
}

}  // namespace raykiln::render::io
