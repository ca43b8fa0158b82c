// Files of the store as the importer sees them.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "raykiln/io/scene_files.hpp"
#include "raykiln/store/store.hpp"

namespace raykiln::server {

class BlobSceneFiles final : public render::SceneFiles {
 public:
  explicit BlobSceneFiles(const std::vector<BlobFile>& files);
  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] std::unique_ptr<render::SceneFile> open(const std::string& name) const override;

 private:
  std::map<std::string, std::filesystem::path> paths_;
};

}  // namespace raykiln::server
