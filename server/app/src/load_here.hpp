// Reading a scene of the user's own machine, for the commands that need no daemon.
#pragma once

#include "raykiln/app/scene_package.hpp"
#include "raykiln/io/import.hpp"
#include "raykiln/workers/scene_intake.hpp"

namespace raykiln::server {

/// The scene as the server would take it. Errors: those of find_scene_files and of the intake.
[[nodiscard]] Result<LoadedScene> load_here(const std::filesystem::path& scene,
                                            bool allow_missing);
[[nodiscard]] Result<LoadedScene> load_here(const ScenePackage& package);

/// The same before anything of it is judged or dropped.
[[nodiscard]] Result<render::ImportResult> import_here(const std::filesystem::path& scene);

}  // namespace raykiln::server
