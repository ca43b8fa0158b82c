// Textures of a glTF file: samplers, images and KHR_texture_transform.
#pragma once

#include <optional>

#include "gltf_buffers.hpp"
#include "scene_draft.hpp"

namespace raykiln::render::io {

class GltfTextures {
 public:
  GltfTextures(const SceneFiles& files, JsonAt root, GltfBuffers& buffers, SceneDraft& draft);

  /// What the textureInfo member `key` of `holder` asks for; unused where it is absent or left out.
  /// Nothing after an error.
  std::optional<TextureUse> use(const JsonAt& holder, const char* key, PictureRole role);

 private:
  std::optional<JsonAt> element(const char* list, std::uint64_t index, const JsonAt& at);
  bool read_sampler(const JsonAt& texture, TextureUse& use);
  std::optional<std::uint32_t> image(const JsonAt& texture, PictureRole role);

  const SceneFiles* files_;
  JsonAt root_;
  GltfBuffers* buffers_;
  SceneDraft* draft_;
};

}  // namespace raykiln::render::io
