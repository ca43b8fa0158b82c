#include "obj_faces.hpp"

#include <limits>
#include <string>

#include "text_numbers.hpp"
#include "triangulate.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::uint64_t kFacesPerPoll = 4096;

}  // namespace

// 1 is the first element, -1 the latest one. A positive index beyond what is defined so far is kept:
// whether it exists is known at the end of the file.
bool ObjFaces::resolve(std::int64_t index, std::size_t defined, std::string_view what,
                       std::uint32_t& resolved) {
  const auto count = static_cast<std::int64_t>(defined);
  if (index > 0 && index < std::numeric_limits<std::uint32_t>::max()) {
    resolved = static_cast<std::uint32_t>(index - 1);
    return true;
  }
  if (index < 0 && index >= -count) {
    resolved = static_cast<std::uint32_t>(count + index);
    return true;
  }
  return reader_->fail(ImportErrorCode::kIndexOutOfRange,
                       "the face refers to " + std::string(what) + " " + std::to_string(index) +
                           ", but there are " + std::to_string(count) + " before it",
                       "indices count from 1, or from -1 backwards");
}

// "p", "p/t", "p//n" or "p/t/n". An index of texture coordinates that leads nowhere is as none: most
// files name some and never use them.
bool ObjFaces::parse_corner(std::string_view word, FaceCorner& corner) {
  const std::string_view whole = word;
  const auto malformed = [&] {
    return reader_->fail(ImportErrorCode::kSyntax,
                         "cannot read the face corner " + in_quotes(whole),
                         "a corner is v, v/vt, v//vn or v/vt/vn");
  };
  std::int64_t position = 0;
  std::int64_t texture = 0;
  std::int64_t normal = 0;
  if (!take_integer(word, position)) return malformed();
  if (!resolve(position, draft_->positions.size(), "vertex", corner.position)) return false;
  corner.normal = kNoNormal;
  corner.uv = kNoUv;
  if (word.empty()) return true;
  if (word[0] != '/') return malformed();
  word.remove_prefix(1);
  if (!word.empty() && word[0] != '/' && !take_integer(word, texture)) return malformed();
  const auto coordinates =
      static_cast<std::int64_t>(draft_->textures.uv_sets[0].coordinates.size());
  if (texture < 0) texture += coordinates + 1;
  if (texture > 0 && texture < std::int64_t{kNoUv}) {
    corner.uv = static_cast<std::uint32_t>(texture - 1);
  }
  if (word.empty()) return true;
  if (word[0] != '/') return malformed();
  word.remove_prefix(1);
  if (word.empty()) return true;  // "1/2/": seen in the wild, and clear
  if (!take_integer(word, normal) || !word.empty()) return malformed();
  return resolve(normal, draft_->normals.size(), "normal", corner.normal);
}

bool ObjFaces::add(std::string_view words, std::uint32_t material, std::uint32_t object) {
  if (++faces_since_poll_ % kFacesPerPoll == 0 && !diagnostics_->may_go_on()) return false;
  corners_.clear();
  bool complete = true;
  while (true) {
    const std::string_view word = take_word(words);
    if (word.empty() || word[0] == '#') break;
    FaceCorner corner;
    if (!parse_corner(word, corner)) return false;
    complete = complete && corner.position < draft_->positions.size() &&
               (corner.normal == kNoNormal || corner.normal < draft_->normals.size());
    corners_.push_back(corner);
  }
  if (corners_.size() < 3) {
    return reader_->fail(ImportErrorCode::kSyntax, "a face needs at least 3 corners");
  }
  if (corners_.size() > diagnostics_->limits().max_polygon_corners) {
    return reader_->fail(ImportErrorCode::kLimitExceeded,
                         "the face has " + std::to_string(corners_.size()) + " corners, more than " +
                             std::to_string(diagnostics_->limits().max_polygon_corners),
                         "triangulate the mesh before the export");
  }
  if (complete) {
    draft_->use_object(object);
    return emit(corners_, material, reader_->line());
  }
  const std::size_t begin = waiting_corners_.size();
  waiting_corners_.insert(waiting_corners_.end(), corners_.begin(), corners_.end());
  waiting_.push_back({reader_->line(), material, object, begin, waiting_corners_.size()});
  return true;
}

bool ObjFaces::finish() {
  for (const Waiting& face : waiting_) {
    const std::span<const FaceCorner> corners(waiting_corners_.data() + face.begin,
                                              face.end - face.begin);
    for (const FaceCorner& corner : corners) {
      const bool bad_position = corner.position >= draft_->positions.size();
      const bool bad_normal = corner.normal != kNoNormal && corner.normal >= draft_->normals.size();
      if (!bad_position && !bad_normal) continue;
      const std::uint64_t index = bad_position ? corner.position : corner.normal;
      const std::size_t count = bad_position ? draft_->positions.size() : draft_->normals.size();
      return diagnostics_->fail(ImportErrorCode::kIndexOutOfRange,
                                std::string("the face refers to ") +
                                    (bad_position ? "vertex " : "normal ") +
                                    std::to_string(index + 1) + ", but the file has " +
                                    std::to_string(count),
                                reader_->file_name(), line_text(face.line),
                                "indices count from 1, or from -1 backwards");
    }
    draft_->use_object(face.object);
    if (!emit(corners, face.material, face.line)) return false;
  }
  return diagnostics_->may_go_on();
}

bool ObjFaces::room_for(std::size_t triangles, std::uint64_t line) {
  const std::uint64_t limit = diagnostics_->limits().max_triangles;
  if (draft_->triangles.size() + triangles <= limit) return true;
  return diagnostics_->fail(ImportErrorCode::kLimitExceeded,
                            "the scene has more than " + std::to_string(limit) + " triangles",
                            reader_->file_name(), line_text(line), "simplify or split the scene");
}

bool ObjFaces::emit(std::span<const FaceCorner> corners, std::uint32_t material,
                    std::uint64_t line) {
  if (!room_for(corners.size() - 2, line)) return false;
  if (corners.size() > 3) return emit_polygon(corners, material, line);
  emit_triangle(corners[0], corners[1], corners[2], material);
  return true;
}

bool ObjFaces::emit_polygon(std::span<const FaceCorner> corners, std::uint32_t material,
                            std::uint64_t line) {
  points_.clear();
  pieces_.clear();
  for (const FaceCorner& corner : corners) points_.push_back(draft_->positions[corner.position]);
  if (corners.size() > 64 && !diagnostics_->may_go_on()) return false;
  const PolygonStatus status = triangulate(points_, pieces_);
  if (status == PolygonStatus::kTooManyToClip) {
    return diagnostics_->fail(
        ImportErrorCode::kLimitExceeded,
        "the concave face has " + std::to_string(corners.size()) + " corners, more than " +
            std::to_string(kMaxConcaveCorners),
        reader_->file_name(), line_text(line), "triangulate the mesh before the export");
  }
  if (status == PolygonStatus::kCrossing) {
    diagnostics_->warn(ImportWarningCode::kBadPolygon,
                       "polygons that cross or touch themselves were cut as well as possible",
                       reader_->file_name(), line_text(line));
  }
  for (const auto& piece : pieces_) {
    emit_triangle(corners[piece[0]], corners[piece[1]], corners[piece[2]], material);
  }
  return true;
}

void ObjFaces::emit_triangle(const FaceCorner& a, const FaceCorner& b, const FaceCorner& c,
                             std::uint32_t material) {
  draft_->add_triangle({a.position, b.position, c.position}, {a.normal, b.normal, c.normal},
                       material);
  if (a.uv == kNoUv && b.uv == kNoUv && c.uv == kNoUv) return;
  draft_->textures.add_corners(0, draft_->triangles.size() - 1, {a.uv, b.uv, c.uv});
}

}  // namespace raykiln::render::io
