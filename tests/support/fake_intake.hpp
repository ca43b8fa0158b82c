// A SceneIntake without files: a room with a lamp, made here.
#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "raykiln/workers/scene_intake.hpp"

namespace raykiln::tests {

/// A floor and a lamp above it. `albedo` changes a material, `width` the geometry.
inline render::Scene tiny_scene(float albedo = 0.5F, float width = 2.0F) {
  render::Scene scene;
  const float w = width;
  scene.mesh.positions = {{-w, 0.0F, -w},      {w, 0.0F, -w},      {w, 0.0F, w},
                          {-w, 0.0F, w},       {-0.5F, 2.0F, -0.5F}, {0.5F, 2.0F, -0.5F},
                          {0.5F, 2.0F, 0.5F},  {-0.5F, 2.0F, 0.5F}};
  scene.mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  scene.mesh.material_ids = {0, 0, 1, 1};
  render::Material floor;
  floor.name = "floor";
  floor.diffuse = render::Rgb(albedo);
  render::Material lamp;
  lamp.name = "lamp";
  lamp.emission = render::Rgb(5.0F);
  scene.materials = {floor, lamp};
  render::Camera camera;
  camera.name = "main";
  camera.eye = {0.0F, 1.0F, 5.0F};
  scene.cameras = {camera};
  scene.background = render::Rgb(0.1F);
  for (const auto& p : scene.mesh.positions) scene.bounds.grow(p);
  return scene;
}

class FakeIntake final : public server::SceneIntake {
 public:
  server::Result<server::LoadedScene> load(server::SceneKind,
                                           const std::vector<server::BlobFile>& files,
                                           server::MissingTextures, std::stop_token) override {
    ++loads;
    server::SceneReport report;
    report.format = "obj";
    report.cameras = {"main"};
    report.triangles = 4;
    auto scene = make ? make(files.front()) : tiny_scene();
    return server::LoadedScene{std::make_shared<const render::Scene>(std::move(scene)), report};
  }

  std::function<render::Scene(const server::BlobFile&)> make;
  std::atomic<int> loads{0};
};

}  // namespace raykiln::tests
