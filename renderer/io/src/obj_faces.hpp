// The faces of an OBJ file: index resolution and triangulation.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "line_reader.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

/// One corner as it will be stored: indices from 0.
struct FaceCorner {
  std::uint32_t position = 0;
  std::uint32_t normal = kNoNormal;
  std::uint32_t uv = kNoUv;
};

class ObjFaces {
 public:
  ObjFaces(LineReader& reader, Diagnostics& diagnostics, SceneDraft& draft)
      : reader_(&reader), diagnostics_(&diagnostics), draft_(&draft) {}

  /// The words of an `f` statement. Faces that refer to vertices further down wait for the end.
  bool add(std::string_view words, std::uint32_t material, std::uint32_t object);
  /// Resolves the waiting faces. Call once, after the last statement.
  bool finish();

 private:
  struct Waiting {
    std::uint64_t line;
    std::uint32_t material, object;
    std::size_t begin, end;  ///< corners in waiting_corners_
  };

  bool parse_corner(std::string_view word, FaceCorner& corner);
  bool resolve(std::int64_t index, std::size_t defined, std::string_view what,
               std::uint32_t& resolved);
  bool emit(std::span<const FaceCorner> corners, std::uint32_t material, std::uint64_t line);
  bool emit_polygon(std::span<const FaceCorner> corners, std::uint32_t material,
                    std::uint64_t line);
  bool room_for(std::size_t triangles, std::uint64_t line);
  void emit_triangle(const FaceCorner& a, const FaceCorner& b, const FaceCorner& c,
                     std::uint32_t material);

  LineReader* reader_;
  Diagnostics* diagnostics_;
  SceneDraft* draft_;
  std::vector<FaceCorner> corners_;
  std::vector<Vec3d> points_;
  std::vector<std::array<std::uint32_t, 3>> pieces_;
  std::vector<FaceCorner> waiting_corners_;
  std::vector<Waiting> waiting_;
  std::uint64_t faces_since_poll_ = 0;
};

}  // namespace raykiln::render::io
