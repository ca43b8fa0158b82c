#include "raykiln/io/import.hpp"

namespace raykiln::render {

std::string_view name(ImportErrorCode code) {
  switch (code) {
    case ImportErrorCode::kNoSceneFile: return "no_scene_file";
    case ImportErrorCode::kAmbiguousScene: return "ambiguous_scene";
    case ImportErrorCode::kFileMissing: return "file_missing";
    case ImportErrorCode::kFileUnreadable: return "file_unreadable";
    case ImportErrorCode::kFileTooLarge: return "file_too_large";
    case ImportErrorCode::kUnsafeFileName: return "unsafe_file_name";
    case ImportErrorCode::kUnsupportedEncoding: return "unsupported_encoding";
    case ImportErrorCode::kSyntax: return "syntax";
    case ImportErrorCode::kLineTooLong: return "line_too_long";
    case ImportErrorCode::kNotFinite: return "not_finite";
    case ImportErrorCode::kCoordinateTooLarge: return "coordinate_too_large";
    case ImportErrorCode::kIndexOutOfRange: return "index_out_of_range";
    case ImportErrorCode::kLimitExceeded: return "limit_exceeded";
    case ImportErrorCode::kInvalidJson: return "invalid_json";
    case ImportErrorCode::kJsonTooDeep: return "json_too_deep";
    case ImportErrorCode::kWrongType: return "wrong_type";
    case ImportErrorCode::kMissingField: return "missing_field";
    case ImportErrorCode::kUnknownField: return "unknown_field";
    case ImportErrorCode::kInvalidValue: return "invalid_value";
    case ImportErrorCode::kInvalidGlb: return "invalid_glb";
    case ImportErrorCode::kBufferOutOfRange: return "buffer_out_of_range";
    case ImportErrorCode::kInvalidPicture: return "invalid_picture";
    case ImportErrorCode::kNodeCycle: return "node_cycle";
    case ImportErrorCode::kUnsupportedVersion: return "unsupported_version";
    case ImportErrorCode::kUnsupportedExtension: return "unsupported_extension";
    case ImportErrorCode::kEmptyScene: return "empty_scene";
    case ImportErrorCode::kStopped: return "stopped";
  }
  return "unknown";
}

std::string_view name(ImportWarningCode code) {
  switch (code) {
    case ImportWarningCode::kMissingMaterialFile: return "missing_material_file";
    case ImportWarningCode::kUnknownMaterial: return "unknown_material";
    case ImportWarningCode::kUnknownStatement: return "unknown_statement";
    case ImportWarningCode::kIgnoredElement: return "ignored_element";
    case ImportWarningCode::kIgnoredTexture: return "ignored_texture";
    case ImportWarningCode::kIgnoredFeature: return "ignored_feature";
    case ImportWarningCode::kIgnoredExtension: return "ignored_extension";
    case ImportWarningCode::kUnsupportedLight: return "unsupported_light";
    case ImportWarningCode::kUnsupportedCamera: return "unsupported_camera";
    case ImportWarningCode::kBadPolygon: return "bad_polygon";
    case ImportWarningCode::kZeroAreaTriangles: return "zero_area_triangles";
    case ImportWarningCode::kCollapsedTriangles: return "collapsed_triangles";
    case ImportWarningCode::kCoarseCoordinates: return "coarse_coordinates";
    case ImportWarningCode::kNotConserving: return "not_conserving";
    case ImportWarningCode::kClampedValue: return "clamped_value";
    case ImportWarningCode::kDefaultMaterial: return "default_material";
    case ImportWarningCode::kDefaultBackground: return "default_background";
    case ImportWarningCode::kDefaultCamera: return "default_camera";
    case ImportWarningCode::kNoLight: return "no_light";
    case ImportWarningCode::kZeroLight: return "zero_light";
    case ImportWarningCode::kInvalidNormal: return "invalid_normal";
    case ImportWarningCode::kMoreWarnings: return "more_warnings";
  }
  return "unknown";
}

std::string_view name(SceneFormat format) {
  switch (format) {
    case SceneFormat::kObj: return "obj";
    case SceneFormat::kGltf: return "gltf";
    case SceneFormat::kGlb: return "glb";
  }
  return "unknown";
}

}  // namespace raykiln::render
