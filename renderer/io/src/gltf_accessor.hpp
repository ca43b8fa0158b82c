// Typed arrays of a glTF file.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gltf_buffers.hpp"
#include "raykiln/math/vec.hpp"

namespace raykiln::render::io {

/// Reads accessors. Every offset, stride and length is checked against the bytes that are there
/// before anything is allocated, so that a claimed count costs nothing.
class GltfAccessors {
 public:
  GltfAccessors(JsonAt root, GltfBuffers& buffers);

  /// Elements that accessor `index` claims to have. `at` is who refers to it, for errors.
  std::optional<std::uint64_t> count(std::uint64_t index, const JsonAt& at);
  /// True when the accessor has bytes; without any, all of its elements are zero.
  [[nodiscard]] bool has_bytes(std::uint64_t index, const JsonAt& at);

  /// A VEC3 accessor of any component type; normalised integers become [-1, 1] or [0, 1]. Non-finite
  /// values are an error that names the element.
  std::optional<std::vector<Vec3d>> vectors(std::uint64_t index, const JsonAt& at) {
    return vectors(index, at, 3);
  }
  /// The same for a VEC2 accessor; the third component is 0.
  std::optional<std::vector<Vec3d>> pairs(std::uint64_t index, const JsonAt& at) {
    return vectors(index, at, 2);
  }
  /// A SCALAR accessor of unsigned integers.
  std::optional<std::vector<std::uint32_t>> indices(std::uint64_t index, const JsonAt& at);

 private:
  /// Checked bytes: element i begins at data + i * stride; null data means zeros.
  struct Layout {
    const char* data = nullptr;
    std::uint64_t count = 0;
    std::size_t stride = 0;
    std::uint64_t component_type = 0;
    bool normalized = false;
  };
  std::optional<JsonAt> accessor(std::uint64_t index, const JsonAt& at);
  std::optional<Layout> layout(const JsonAt& accessor, std::string_view type,
                               std::size_t components);
  /// Places `count` elements of `size` bytes in a buffer view; null, with an error, when they do not
  /// fit.
  const char* place(std::uint64_t view, std::uint64_t offset, std::uint64_t count,
                    std::size_t size, std::size_t& stride, const JsonAt& at);
  std::optional<std::vector<Vec3d>> vectors(std::uint64_t index, const JsonAt& at, int components);
  bool apply_sparse(const JsonAt& accessor, const Layout& layout, int components,
                    std::vector<Vec3d>& values);

  std::optional<JsonAt> accessors_;
  GltfBuffers* buffers_;
};

}  // namespace raykiln::render::io
