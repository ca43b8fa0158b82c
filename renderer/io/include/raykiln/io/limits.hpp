// What an import accepts at most. Everything is counted before it is stored.
#pragma once

#include <cstddef>
#include <cstdint>

namespace raykiln::render {

struct ImportLimits {
  std::uint64_t max_triangles = 50'000'000;
  std::uint64_t max_vertices = 50'000'000;  ///< positions, and vertex normals, each
  std::size_t max_materials = 100'000;
  std::size_t max_cameras = 1'000;
  std::size_t max_lights = 100'000;
  double max_coordinate = 1e15;  ///< largest |world coordinate|, metres
  double max_radiance = 1e30;    ///< largest component of any emission, light or background

  std::uint64_t max_environment_texels = std::uint64_t{1} << 24;
  std::uint64_t max_texture_texels = std::uint64_t{1} << 26;  ///< of one picture
  std::uint64_t max_texture_bytes = std::uint64_t{1} << 30;   ///< of all, decoded
  std::size_t max_textures = 10'000;
  std::uint64_t max_picture_file_bytes = std::uint64_t{512} << 20;

  std::uint64_t max_file_bytes = std::uint64_t{8} << 30;  ///< of one OBJ
  std::uint64_t max_buffer_bytes = std::uint64_t{4} << 30;  ///< of all glTF buffers together
  std::size_t max_json_bytes = std::size_t{256} << 20;
  std::size_t max_json_depth = 64;
  std::size_t max_json_values = 5'000'000;
  std::size_t max_line_bytes = std::size_t{1} << 20;  ///< of one OBJ or MTL statement
  std::size_t max_polygon_corners = 10'000;
  std::size_t max_mtl_bytes = std::size_t{64} << 20;
  std::size_t max_mtl_files = 1'000;
  std::size_t max_node_depth = 256;
  std::uint64_t max_node_visits = 1'000'000;
  std::uint64_t max_primitive_visits = 5'000'000;  ///< primitives times their instances
  std::size_t max_warnings = 64;  ///< distinct ones; the rest are counted together
};

}  // namespace raykiln::render
