#include "raykiln/scheduler/render_inputs.hpp"

#include <algorithm>
#include <numbers>

#include "raykiln/render/missing_light.hpp"

namespace raykiln::server {
namespace {

Error no_such_camera(const std::string& what) {
  return {ErrorKind::kInvalid, "invalid_request", "the scene has no camera " + what, "/camera"};
}

render::Vec3d vec(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

/// In double up to the last step: eye and origin may be large and close together.
render::Camera camera_of(const OwnCamera& own, const render::Scene& scene) {
  const render::Vec3d forward = render::normalize(vec(own.look_at) - vec(own.eye));
  const render::Vec3d right =
      render::normalize(render::cross(forward, render::normalize(vec(own.up))));
  render::Camera camera;
  camera.name = "own";
  camera.eye = vec(own.eye) - scene.origin;
  camera.right = right;
  camera.up = render::cross(right, forward);
  camera.forward = forward;
  camera.fov_y_rad = own.fov_deg * std::numbers::pi / 180.0;
  if (own.view_height) {
    camera.projection = render::Projection::kOrthographic;
    camera.view_height = *own.view_height;
  }
  return camera;
}

std::optional<int> index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<int>(found - names.begin());
}

std::vector<std::string> camera_names(const render::Scene& scene) {
  std::vector<std::string> names;
  for (const render::Camera& camera : scene.cameras) names.push_back(camera.name);
  return names;
}

Result<int> camera_index(const CameraChoice& choice, const std::vector<std::string>& names) {
  if (const auto* index = std::get_if<int>(&choice)) {
    if (*index >= 0 && static_cast<std::size_t>(*index) < names.size()) return *index;
    return no_such_camera(std::to_string(*index));
  }
  if (const auto* name = std::get_if<std::string>(&choice)) {
    if (const auto index = index_of(names, *name)) return *index;
    return no_such_camera("of this name");
  }
  return 0;  // a camera of the user's own: the index is not used
}

render::LightModel light_model_of(const JobRequest& request) {
  render::LightModel m = request.light_model == LightModel::kSeed ? render::kSeedModel
                                                                  : render::kPhysicalModel;
  const LightModelOverrides& o = request.light_model_overrides;
  if (o.phong) {
    m.phong = *o.phong == PhongDivisor::kMax ? render::PhongCosine::kMax
                                             : render::PhongCosine::kOverCosO;
  }
  if (o.fresnel) {
    m.fresnel = *o.fresnel == FresnelFormula::kExact ? render::FresnelFormula::kExact
                                                     : render::FresnelFormula::kSchlick;
  }
  m.radiance_scaling = o.radiance_scaling.value_or(m.radiance_scaling);
  if (o.diffuse_sampling) {
    m.diffuse_sampling = *o.diffuse_sampling == DiffuseSampling::kCosine
                             ? render::DiffuseSampling::kCosine
                             : render::DiffuseSampling::kUniform;
  }
  m.roulette = o.roulette.value_or(m.roulette);
  return m;
}

render::EmitterChoice emitter_choice_of(const JobRequest& request) {
  switch (request.emitter_choice) {
    case EmitterChoice::kPower: return render::EmitterChoice::kPower;
    case EmitterChoice::kTree: return render::EmitterChoice::kTree;
    case EmitterChoice::kAuto: break;
  }
  return render::EmitterChoice::kAuto;
}

void add_once(JobWarning warning, std::vector<JobWarning>& warnings) {
  const bool known = std::any_of(warnings.begin(), warnings.end(),
                                 [&](const JobWarning& w) { return w.code == warning.code; });
  if (!known) warnings.push_back(std::move(warning));
}

}  // namespace

void warn_of_light_model(const render::RenderSettings& settings, const render::Scene& scene,
                         std::vector<JobWarning>& warnings) {
  for (const auto& found : render::light_model_warnings(settings.light_model, scene)) {
    add_once({found.code, found.message, "/light_model"}, warnings);
  }
}

void warn_of_approximation(const EffectReport& report, std::vector<JobWarning>& warnings) {
  std::string names;
  for (const EffectLine& line : report.lines) {
    if (!line.called_for || line.simulated) continue;
    names += names.empty() ? "" : ", ";
    names += line.name + " (" + line.grade + ')';
  }
  if (names.empty()) return;
  add_once({"deliberate_approximation",
            "the picture lacks what the scene calls for, on request: " + names, "/effects"},
           warnings);
}

void warn_of_picture(const render::RenderSettings& settings, const render::Scene& scene,
                     const render::BuildStats& tree, std::vector<JobWarning>& warnings) {
  for (const auto& found : render::render_notices(settings, scene, tree)) {
    add_once({found.code, found.message, ""}, warnings);
  }
}

void warn_of_missing_light(const render::RenderSettings& settings, const render::PreparedScene& scene,
                           std::vector<JobWarning>& warnings, const std::stop_token& stop) {
  for (const auto& found : render::missing_light_notices(scene, settings, stop)) {
    add_once({found.code, found.message, found.code == "unseen_light" ? "/emitter_sampling" : "/max_depth"},
             warnings);
  }
}

std::uint64_t film_memory(const JobRequest& request) {
  const std::uint64_t film = render::film_bytes(request.width, request.height);
  // RGB and the seconds of a pixel.
  const std::uint64_t picture = std::uint64_t{4 * sizeof(float)} *
                                static_cast<std::uint64_t>(request.width) *
                                static_cast<std::uint64_t>(request.height);
  const std::uint64_t layers = render::LayerFilm::bytes_per_pixel(render::layer_set_of(request.layers).value_or(render::LayerSet())) *
                               static_cast<std::uint64_t>(request.width) * static_cast<std::uint64_t>(request.height);
  return film > UINT64_MAX - picture - layers ? UINT64_MAX : film + picture + layers;
}

Status check_camera(const CameraChoice& choice, const SceneReport& report) {
  if (auto index = camera_index(choice, report.cameras); !index) return index.error();
  return success();
}

render::Sampler sampler_of(const JobRequest& request) {
  return request.sampler == Sampler::kSobol ? render::Sampler::kSobol : render::Sampler::kRandom;
}

Result<render::RenderSettings> render_settings(const JobRequest& request,
                                               const render::Scene& scene) {
  const auto index = camera_index(request.camera, camera_names(scene));
  if (!index) return index.error();
  render::RenderSettings settings;
  settings.width = request.width;
  settings.height = request.height;
  settings.camera = *index;
  if (const auto* own = std::get_if<OwnCamera>(&request.camera)) {
    settings.own_camera = camera_of(*own, scene);
  }
  if (request.lens) {
    if (!settings.own_camera) settings.own_camera = scene.cameras[static_cast<std::size_t>(*index)];
    settings.own_camera->lens = {request.lens->radius, request.lens->focus_distance};
  }
  if (const auto& crop = request.crop) {
    settings.crop = render::Crop{crop->x, crop->y, crop->full_width, crop->full_height};
  }
  settings.light_model = light_model_of(request);
  settings.max_depth = depth_limit(request);
  settings.branches = request.branches;
  settings.seed = request.seed;
  settings.pixel_mode = request.pixel_mode == PixelMode::kRandom ? render::PixelMode::kRandom
                                                                 : render::PixelMode::kCentre;
  settings.pixel_filter = request.filter == PixelFilter::kBox ? render::PixelFilter::kBox
                                                              : render::PixelFilter::kBlackmanHarris;
  settings.direction_sampling = request.direction_sampling == DirectionSampling::kBsdf
                                    ? render::DirectionSampling::kBsdf
                                    : render::DirectionSampling::kUniformSphere;
  settings.emitter_sampling = request.emitter_sampling;
  settings.emitter_choice = emitter_choice_of(request);
  settings.texture_reading = request.texture_filter == TextureFilter::kExact ? render::TextureReading::kExact
                                                                             : render::TextureReading::kFootprint;
  settings.sampler = sampler_of(request);
  const auto effects = render::effect_choice_of(request.effects);
  if (!effects) {
    // A job that an older version stored may name what is gone.
    return Error{ErrorKind::kInvalid, "invalid_request", "there is no such effect", "/effects"};
  }
  settings.effects = *effects;
  const auto layers = render::layer_set_of(request.layers);
  if (!layers) return Error{ErrorKind::kInvalid, "invalid_request", "there is no such layer", "/layers"};
  settings.layers = *layers;
  if (const auto wrong = render::settings_error(settings, scene)) {
    return Error{ErrorKind::kInvalid, "invalid_request", *wrong, ""};
  }
  return settings;
}

}  // namespace raykiln::server
