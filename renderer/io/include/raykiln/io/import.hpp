// Bytes -> validated scene. The one entry point for every scene file format.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "raykiln/io/limits.hpp"
#include "raykiln/io/scene_files.hpp"
#include "raykiln/scene/scene.hpp"

namespace raykiln::render {

/// Why an import was refused. The snake_case names (see name()) are stable.
enum class ImportErrorCode {
  kNoSceneFile,
  kAmbiguousScene,
  kFileMissing,
  kFileUnreadable,
  kFileTooLarge,
  kUnsafeFileName,
  kUnsupportedEncoding,
  kSyntax,
  kLineTooLong,
  kNotFinite,
  kCoordinateTooLarge,
  kIndexOutOfRange,
  kLimitExceeded,
  kInvalidJson,
  kJsonTooDeep,
  kWrongType,
  kMissingField,
  kUnknownField,
  kInvalidValue,
  kInvalidGlb,
  kBufferOutOfRange,
  kInvalidPicture,
  kNodeCycle,
  kUnsupportedVersion,
  kUnsupportedExtension,
  kEmptyScene,
  kStopped,
};

/// What an import accepted but did not take as it stands.
enum class ImportWarningCode {
  kMissingMaterialFile,
  kUnknownMaterial,
  kUnknownStatement,
  kIgnoredElement,
  kIgnoredTexture,
  kIgnoredFeature,
  kIgnoredExtension,
  kUnsupportedLight,
  kUnsupportedCamera,
  kBadPolygon,
  kZeroAreaTriangles,
  kCollapsedTriangles,
  kCoarseCoordinates,
  kNotConserving,
  kClampedValue,
  kDefaultMaterial,
  kDefaultBackground,
  kDefaultCamera,
  kNoLight,
  kZeroLight,
  kInvalidNormal,
  kMoreWarnings,
};

[[nodiscard]] std::string_view name(ImportErrorCode code);
[[nodiscard]] std::string_view name(ImportWarningCode code);

/// All texts are valid UTF-8 without control characters, at most a few hundred bytes each.
struct ImportError {
  ImportErrorCode code = ImportErrorCode::kSyntax;
  std::string message;  ///< what is wrong, for people
  std::string file;     ///< name within the upload; empty when it is about the upload as a whole
  std::string where;    ///< "line 12" or a JSON pointer such as "/meshes/0"; may be empty
  std::string remedy;   ///< what to do about it; may be empty
};

struct ImportWarning {
  ImportWarningCode code = ImportWarningCode::kUnknownStatement;
  std::string message;
  std::string file;
  std::string where;        ///< of the first occurrence
  std::uint64_t count = 1;  ///< occurrences
};

enum class SceneFormat { kObj, kGltf, kGlb };
[[nodiscard]] std::string_view name(SceneFormat format);

struct ImportReport {
  SceneFormat format = SceneFormat::kObj;
  std::string root_file;
  std::vector<ImportWarning> warnings;  ///< in order of first occurrence
  std::uint64_t source_triangles = 0;   ///< after triangulation and instancing, before dropping
  std::uint64_t zero_area_triangles = 0;  ///< dropped
};

struct ImportedScene {
  Scene scene;
  ImportReport report;
};

struct ImportOptions {
  ImportLimits limits;
  std::stop_token stop;   ///< polled at least every few milliseconds; ends with kStopped
  std::string root_file;  ///< names the file to read; empty: the sidecar's "scene", or the only one
  bool allow_missing = false;  ///< textures that cannot be had are left out; so says a sidecar, too
};

using ImportResult = std::variant<ImportedScene, ImportError>;

/// Name of the optional sidecar; it lies beside the root file or at the top of the upload.
inline constexpr std::string_view kSidecarName = "raykiln.json";

/// Reads, validates and flattens the scene in `files`. A pure function of the bytes and options; no
/// threads. Throws only std::bad_alloc. The scene has at least one triangle, one material and one
/// camera; every float in it is finite; every index is in range; |coordinates| are bounded.
[[nodiscard]] ImportResult import_scene(const SceneFiles& files, const ImportOptions& options = {});

}  // namespace raykiln::render
