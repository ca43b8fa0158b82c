// The buffers of a glTF file, each read when it is first needed.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "json_at.hpp"

namespace raykiln::render::io {

class GltfBuffers {
 public:
  /// `glb_chunk` is the binary chunk of a GLB, or nothing; it must outlive this object.
  GltfBuffers(const SceneFiles& files, JsonAt root, std::optional<std::string_view> glb_chunk);

  /// Bytes of buffer view `index`, in range of its buffer. `at` is who asks, for errors.
  std::optional<std::string_view> view(std::uint64_t index, const JsonAt& at);
  /// The view's byteStride; 0 when it has none. Call after view() succeeded.
  [[nodiscard]] std::uint64_t stride(std::uint64_t index) const;

 private:
  std::optional<std::string_view> buffer(std::uint64_t index, const JsonAt& at);
  bool load(std::size_t index, const JsonAt& at);
  bool load_uri(std::string_view uri, const JsonAt& at, std::string& bytes);

  const SceneFiles* files_;
  JsonAt root_;
  std::optional<std::string_view> glb_chunk_;
  std::optional<JsonAt> buffers_, views_;
  std::vector<std::string> owned_;
  std::vector<std::optional<std::string_view>> loaded_;
  std::uint64_t total_bytes_ = 0;
};

}  // namespace raykiln::render::io
