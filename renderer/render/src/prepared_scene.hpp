// A scene with everything that rendering derives from it.
#pragma once

#include <memory>

#include "raykiln/render/render.hpp"
#include "raykiln/shading/caustic_casters.hpp"
#include "raykiln/shading/emitters.hpp"

namespace raykiln::render {

class PreparedScene {
 public:
  PreparedScene(std::shared_ptr<const Scene> scene, std::shared_ptr<const KdTree> tree)
      : scene_(std::move(scene)), tree_(std::move(tree)), emitters_(*scene_), pyramids_(scene_->textures.get()),
        casters_(emitters_.has_triangles() ? find_caustic_casters(*scene_) : std::vector<CausticCaster>()), use_(use_of(*scene_)) {}

  [[nodiscard]] const Scene& scene() const { return *scene_; }
  [[nodiscard]] const KdTree& tree() const { return *tree_; }
  [[nodiscard]] const Emitters& emitters() const { return emitters_; }
  [[nodiscard]] const TexturePyramids& pyramids() const { return pyramids_; }
  /// Bodies that may focus light of emitting triangles; none where nothing shines.
  [[nodiscard]] std::span<const CausticCaster> casters() const { return casters_; }
  [[nodiscard]] const SceneUse& use() const { return use_; }

 private:
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const KdTree> tree_;
  Emitters emitters_;
  TexturePyramids pyramids_;
  std::vector<CausticCaster> casters_;
  SceneUse use_;
};

}  // namespace raykiln::render
