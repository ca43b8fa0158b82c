#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <iostream>

#include "option_text.hpp"
#include "raykiln/api/job_json.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/effects/effect_choice.hpp"
#include "raykiln/image/layers.hpp"

namespace raykiln::server {
namespace {

/// Digits are an index, all else is a name.
CameraChoice camera_choice(const std::string& text) {
  int index = 0;
  const auto* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, index);
  if (text.empty() || (error == std::errc{} && stop == end && index >= 0)) return index;
  return text;
}

void add_light_model(CLI::App& command, JobRequest& request) {
  command.add_option_function<std::string>(
      "--light-model",
      [&request](const std::string& text) {
        const auto model = light_model_named(text);
        if (!model) throw CLI::ValidationError("--light-model is physical or seed");
        request.light_model = *model;
      },
      "physical or seed (physical)");
  command.add_option_function<std::string>(
      "--light-model-overrides",
      [&request](const std::string& text) {
        const auto overrides = overrides_of(text);
        if (!overrides) {
          throw CLI::ValidationError(
              "--light-model-overrides: phong=max|over_cos_o, fresnel=exact|schlick, "
              "radiance_scaling=true|false, diffuse_sampling=cosine|uniform, roulette=true|false");
        }
        request.light_model_overrides = *overrides;
      },
      "switches against the model, such as fresnel=schlick,roulette=false");
}

void add_stops(CLI::App& command, JobRequest& request) {
  command.add_option_function<double>(
             "--seconds", [&request](double seconds) { request.stop.seconds = seconds; },
             "stop after so much time of rendering, in all")
      ->check(CLI::Range(1e-3, JobLimits{}.max_seconds));
  command.add_option_function<std::string>(
      "--error",
      [&request](const std::string& text) {
        request.stop.error = read_error(text);
        if (!request.stop.error) throw CLI::ValidationError("--error wants a number such as 0.02 or 2%");
      },
      "stop when the 95 % interval of the error is below this, such as 2%");
}

/// Without a number of samples, time or error alone end the job.
void complete_stops(const CLI::App& command, JobRequest& request) {
  StopRule& stop = request.stop;
  if ((!stop.seconds && !stop.error) || command.count("--samples") > 0) return;
  stop.samples = JobLimits{}.max_samples;
  if (stop.error && !stop.seconds) stop.seconds = kDefaultErrorSeconds;
}

void add_effects(CLI::App& command, JobRequest& request) {
  command.add_option_function<std::string>(
      "--effects",
      [&request](const std::string& text) {
        const auto choice = render::effect_choice_of(text);
        if (!choice) {
          throw CLI::ValidationError(
              "--effects is auto, all, or without= and names that `raykiln effects` lists");
        }
        request.effects = render::effect_choice_text(*choice);
      },
      "auto: what the scene calls for; all; or without=refraction,... (auto)");
}

void add_tree(CLI::App& command, TreeBudget& tree) {
  const JobLimits limits;
  command.add_option("--tree-references", tree.references_per_triangle,
                     "most references a triangle in the tree; fewer: less memory, longer rays, the same picture")
      ->check(CLI::Range(1.0, limits.max_tree_references))
      ->capture_default_str();
  command.add_option("--tree-bytes", tree.max_bytes, "most that building the tree may hold, such as 500MB (no limit)")
      ->transform(CLI::AsSizeValue(true) & CLI::Range(std::uint64_t{1}, limits.max_tree_bytes));
}

/// What is looked at, and the numbers it is rendered with.
void add_view(CLI::App& command, CliOptions& options, const char* size) {
  JobRequest& request = options.picture.request;
  command.add_option_function<std::string>(
      "--size",
      [&request](const std::string& text) {
        if (auto error = read_size(text, request); !error.empty()) throw CLI::ValidationError(error);
      },
      size);
  command.add_option("--seed", request.seed, "of the random numbers")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9007199254740991}))
      ->capture_default_str();
  command.add_option("--camera", options.picture.camera, "name or index of a camera of the scene");
  command.add_option_function<std::string>(
      "--lens",
      [&request](const std::string& text) {
        request.lens = read_lens(text);
        if (!request.lens) {
          throw CLI::ValidationError(
              "--lens wants RADIUS,FOCUS_DISTANCE: two lengths in metres, the second above 0, such as 0.05,2 for what "
              "is sharp at 2 m");
        }
      },
      "RADIUS,FOCUS_DISTANCE of the camera in metres; 0,1 is a pinhole");
  command.add_option("--crop", options.picture.crop, "X,Y,W,H in pixels: this window of the picture alone")
      ->delimiter(',')->expected(4)->allow_extra_args(false);
}

/// --size is the whole picture, whose window the job's picture becomes.
bool apply_crop(CliOptions& options) {
  const std::vector<int>& crop = options.picture.crop;
  if (crop.empty()) return true;
  JobRequest& request = options.picture.request;
  request.crop = Crop{crop[0], crop[1], request.width, request.height};
  const bool inside = crop[0] >= 0 && crop[1] >= 0 && crop[2] >= 1 && crop[3] >= 1 &&
                      crop[2] <= request.width - crop[0] && crop[3] <= request.height - crop[1];
  request.width = crop[2];
  request.height = crop[3];
  return inside;
}

/// An option that names one of a few values.
template <class Value>
void add_named(CLI::App& command, const char* option, std::optional<Value> (*parse)(std::string_view), Value& target,
               const char* help) {
  command.add_option_function<std::string>(
      option,
      [=, &target](const std::string& text) {
        const auto value = parse(text);
        if (!value) throw CLI::ValidationError(std::string(option) + ": " + help);
        target = *value;
      },
      help);
}

constexpr const char* kSceneFiles = ".obj, .gltf, .glb, .zip or a folder";

void add_picture_options(CLI::App& command, CliOptions& options, const char* what = kSceneFiles) {
  const JobLimits limits;
  JobRequest& request = options.picture.request;
  command.add_option("SCENE", options.scene, what)->required();
  command.add_flag("--allow-missing", options.allow_missing,
                   "textures that are missing or cannot be read are left out with a warning");
  command.add_option("--samples", request.stop.samples, "samples per pixel")
      ->check(CLI::Range(std::uint64_t{1}, limits.max_samples))
      ->capture_default_str();
  add_stops(command, request);
  command.add_option("--depth", request.max_depth,
                     "most reflections after the first hit (1024 with roulette, else 8)")
      ->check(CLI::Range(0, limits.max_depth));
  add_light_model(command, request);
  add_effects(command, request);
  add_view(command, options, "WxH in pixels (640x480)");
  add_named(command, "--sampler", sampler_named, request.sampler,
            "random, or sobol: points that fill space, less noise (random)");
  add_named(command, "--emitter-choice", emitter_choice_named, request.emitter_choice,
            "power, tree, or auto: a tree from 32 emitting triangles on (auto)");
  add_named(command, "--texture-filter", texture_filter_named, request.texture_filter,
            "exact, or footprint: textures as means over what a pixel covers, with less noise and a bias (exact)");
  add_named(command, "--filter", filter_named, request.filter,
            "box, or blackman_harris: softer pixels (box)");
  add_tree(command, request.tree);
  command.add_option("--tile", request.tile, "edge of a tile in pixels; changes no pixel")
      ->check(CLI::Range(1, limits.max_tile))
      ->capture_default_str();
  command.add_option("--exposure", options.picture.exposure_stops, "stops, for PNG")
      ->check(CLI::Range(-32.0, 32.0))
      ->capture_default_str();
}

void add_output(CLI::App& command, CliOptions& options, bool required) {
  auto* option = command.add_option("-o,--output", options.outputs,
                                    "picture file, .exr or .png; may be given twice");
  if (required) option->required();
  command.add_flag("--half", options.picture.half,
                   "EXR in half floats: half the bytes, values beyond 65504 are clamped and counted");
}

void add_job(CLI::App& command, CliOptions& options) {
  command.add_option("JOB", options.job, "job id")->required();
}

void add_comparison(CLI::App& command, ComparisonSettings& settings) {
  command.add_option("--false-alarms", settings.noise.false_alarms,
                     "chance that two renders of one scene are called different")
      ->check(CLI::Range(1e-12, 0.5))
      ->capture_default_str();
  command.add_option("--tolerance", settings.noise.tolerance,
                     "share of brightness by which blocks may change (0: any change counts)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_flag("--thresholds", settings.use_thresholds, "judge by the thresholds below, not by noise");
  auto& thresholds = settings.thresholds;
  command.add_option("--absolute", thresholds.absolute, "a value fails beyond this and --relative")
      ->check(CLI::NonNegativeNumber)->capture_default_str();
  command.add_option("--relative", thresholds.relative, "share of the larger value")
      ->check(CLI::NonNegativeNumber)->capture_default_str();
  command.add_option("--failing-share", thresholds.failing_share, "of pixels that may fail")
      ->check(CLI::Range(0.0, 1.0))->capture_default_str();
  command.add_option("--hard-limit", thresholds.hard_limit, "no value may differ by more (none)")
      ->check(CLI::NonNegativeNumber);
}

void add_compare(CLI::App& app, CompareOptions& options) {
  auto* compare = app.add_subcommand("compare", "is a render its reference, but for the noise of both");
  compare->add_option("RENDER", options.render, ".exr or .png")->required();
  compare->add_option("REFERENCE", options.reference, ".exr or .png")->required();
  compare->add_option("--difference", options.difference, "PNG file: where it is brighter (red), darker (blue)");
  compare->add_option("--z-map", options.z_map, "PNG file: where the difference exceeds the noise");
  add_comparison(*compare, options.settings);
}

void add_batch(CLI::App& app, CliOptions& options) {
  BatchOptions& wanted = options.batch;
  auto* batch = app.add_subcommand("batch", "render and judge all pictures of a file");
  batch->add_option("FILE", wanted.file, "YAML or JSON; see proto/batch.schema.json")->required();
  auto* local = batch->add_flag("--local", wanted.local, "in this process, without a server");
  batch->add_flag("--wait", options.wait, "follow to the end, and judge (implied by --junit, --report, --html)");
  batch->add_option("--timeout", wanted.timeout_seconds, "seconds to wait at most; the batch goes on")->check(CLI::Range(0.0, 1e7));
  batch->add_flag("--cancel-on-interrupt", wanted.cancel_on_interrupt, "Ctrl-C cancels the batch instead of detaching from it");
  batch->add_flag("--no-reuse", wanted.no_reuse, "render what the server has rendered before, too");
  auto* resume = batch->add_option("--resume", wanted.resume, "id of this file's batch, to wait for it again")->excludes(local);
  batch->add_flag("--rerun", wanted.rerun, "render what failed once more")->needs(resume);
  batch->add_option("--idempotency-key", options.idempotency_key, "the same key again gives the same batch")->excludes(local);
  batch->add_option("--threads", options.threads, "with --local; 0: one a processor")->check(CLI::Range(0, 1024));
  batch->add_option("--junit", wanted.junit, "JUnit XML to write");
  batch->add_option("--report", wanted.json, "JSON to write; see proto/batch-report.schema.json");
  batch->add_option("--html", wanted.html, "folder for a report to look at, its pictures and results.json");

  auto* approve = app.add_subcommand("approve", "make pictures of a report the references of the next batch");
  approve->add_option("REPORT", options.approve.report, "folder that batch --html wrote")->required();
  auto* names = approve->add_option("PICTURE", options.approve.pictures, "names");
  approve->add_flag("--all", options.approve.all, "all that differ or have no reference yet")->excludes(names);
}

void add_accuracy(CLI::App& app, CliOptions& options) {
  auto* accuracy = app.add_subcommand(
      "accuracy", "measure what each knob costs on a scene: error against seconds, and bias");
  accuracy->add_option("SCENE", options.scene, kSceneFiles)->required();
  accuracy->add_flag("--allow-missing", options.allow_missing,
                     "textures that are missing or cannot be read are left out with a warning");
  add_view(*accuracy, options, "WxH in pixels, at most 65536 of them (160x120)");
  accuracy->add_option("--seconds", options.accuracy.seconds, "of one processor, for each knob")
      ->check(CLI::Range(1e-3, 86400.0))
      ->capture_default_str();
  accuracy->add_option("--reference-seconds", options.accuracy.reference_seconds,
                       "of one processor, at most; ten times as exact takes a hundred times as long")
      ->check(CLI::Range(1e-3, 8640000.0))
      ->capture_default_str();
  accuracy->add_option("--html", options.accuracy.html, "report to look at, in one file");
  accuracy->add_option("--csv", options.accuracy.csv, "all points");
  accuracy->add_option("--threads", options.threads, "0: one a processor")->check(CLI::Range(0, 1024));
}

void add_adaptive(CLI::App& command, JobRequest& request) {
  command.add_flag("--adaptive", request.adaptive,
                   "samples go where the error is: needs --error or --seconds; marked in every output");
}

void add_layers(CLI::App& command, JobRequest& request) {
  command.add_option_function<std::string>(
      "--layers",
      [&request](const std::string& text) {
        const auto layers = render::layer_set_of(text);
        if (!layers || layers->empty()) {
          throw CLI::ValidationError("--layers wants names separated by commas, out of " + render::all_layer_names());
        }
        request.layers = render::layer_set_text(*layers);
      },
      "further channels of the .exr: " + render::all_layer_names());
}

/// Layers are channels of an EXR of floats: a picture that could not hold them is told before it is rendered.
bool layers_have_a_file(const CliOptions& options) {
  if (options.picture.request.layers.empty() || options.outputs.empty()) return true;
  if (options.picture.half) return false;
  return std::any_of(options.outputs.begin(), options.outputs.end(),
                     [](const auto& output) { return output.extension() == ".exr"; });
}

void add_commands(CLI::App& app, CliOptions& options) {
  auto* render = app.add_subcommand("render", "render a scene here, without a server");
  add_picture_options(*render, options);
  add_output(*render, options, true);
  render->add_option("--threads", options.threads, "0: one a processor")->check(CLI::Range(0, 1024));
  add_adaptive(*render, options.picture.request);
  add_layers(*render, options.picture.request);

  auto* effects = app.add_subcommand("effects", "list what a scene calls for, what is simulated, and why");
  add_picture_options(*effects, options);

  auto* lint = app.add_subcommand("lint", "report what is questionable about a scene");
  lint->add_option("SCENE", options.scene, kSceneFiles)->required();
  app.add_subcommand("selftest", "check this program against scenes with a known answer (under a minute)");

  auto* replay = app.add_subcommand("replay", "render one sample of a job of the server, or of a scene, again and print it");
  add_picture_options(*replay, options,
                      "job id (the options of the picture are the job's then), or a scene");
  replay->add_option("X", options.replay.x, "pixel column, from the left")->required()->check(CLI::NonNegativeNumber);
  replay->add_option("Y", options.replay.y, "pixel row, from the top")->required()->check(CLI::NonNegativeNumber);
  replay->add_option("SAMPLE", options.replay.sample, "index of the sample, from 0")->required();

  add_accuracy(app, options);
  add_compare(app, options.compare);
  add_batch(app, options);
  auto* submit = app.add_subcommand("submit", "upload a scene if the server lacks it, and submit a job");
  add_picture_options(*submit, options);
  add_adaptive(*submit, options.picture.request);
  add_layers(*submit, options.picture.request);
  add_output(*submit, options, false);
  submit->add_flag("--wait", options.wait, "follow the job to its end (implied by -o)");
  submit->add_option("--name", options.picture.request.name, "of the job, for people");
  submit->add_option("--priority", options.picture.request.priority)->check(CLI::Range(1, 100));
  submit->add_flag("--reuse", options.picture.request.reuse, "take the picture of an equal job that has completed, if there is one");
  submit->add_option("--idempotency-key", options.idempotency_key,
                     "the same key again gives the same job");

  auto* extend = app.add_subcommand("extend", "more samples for a completed job, going on from those it has");
  add_job(*extend, options);
  extend->add_option("--samples", options.picture.request.stop.samples, "samples per pixel, in all")
      ->check(CLI::Range(std::uint64_t{1}, JobLimits{}.max_samples));
  add_stops(*extend, options.picture.request);
  add_output(*extend, options, false);
  extend->add_flag("--wait", options.wait, "follow the job to its end (implied by -o)");

  auto* quote = app.add_subcommand("quote", "render a scene on the server for a short time, and print what less error costs");
  add_view(*quote, options, "WxH in pixels (640x480)");
  quote->add_option("SCENE", options.scene, kSceneFiles)->required();
  add_tree(*quote, options.picture.request.tree);
  quote->add_option("--pilot-seconds", options.pilot_seconds, "time of the pilot")
      ->check(CLI::Range(1e-3, kMostPilotSeconds))
      ->capture_default_str();

  auto* watch = app.add_subcommand("watch", "follow a job to its end");
  add_job(*watch, options);
  auto* fetch = app.add_subcommand("fetch", "download the newest picture of a job");
  add_job(*fetch, options);
  add_output(*fetch, options, true);
  fetch->add_option("--exposure", options.picture.exposure_stops, "stops, for PNG")
      ->check(CLI::Range(-32.0, 32.0));
  auto* cancel = app.add_subcommand("cancel", "stop a job and keep its partial picture");
  add_job(*cancel, options);
  app.add_subcommand("scenes", "list the scenes of the server");
  auto* jobs = app.add_subcommand("jobs", "list the jobs of the server");
  jobs->add_option("--state", options.state, "only these states, separated by commas");
  app.add_subcommand("health", "is the server able to take work");
}

}  // namespace

ParsedCli parse_cli_options(int argc, const char* const* argv) {
  ParsedCli parsed;
  CliOptions& options = parsed.options;
  CLI::App app("raykiln: renders scenes, here or on a server");
  app.footer(exit_code_table());
  app.set_version_flag("--version", std::string("raykiln ") + RAYKILN_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--server", options.server, "URL of the daemon")
      ->envname("RAYKILN_SERVER")
      ->capture_default_str();
  app.add_flag("--json", options.json, "results as JSON on standard output");
  app.add_flag("-q,--quiet", options.quiet, "no progress");
  add_commands(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    parsed.exit_code = app.exit(error) == 0 ? 0 : to_int(ExitCode::kUsage);
    return parsed;
  }
  options.command = app.get_subcommands().front()->get_name();
  const CLI::App* used = app.get_subcommands().front();
  if (used->get_option_no_throw("--samples") != nullptr) complete_stops(*used, options.picture.request);
  if (options.command == "extend" && used->count("--samples") + used->count("--seconds") + used->count("--error") == 0) {
    std::cerr << "raykiln: extend needs --samples, --seconds or --error\n";
    parsed.exit_code = to_int(ExitCode::kUsage);
  }
  const StopRule& stop = options.picture.request.stop;
  if (options.picture.request.adaptive) options.picture.request.tile = kAdaptiveTile;
  if (options.picture.request.adaptive && !stop.error && !stop.seconds) {
    std::cerr << "raykiln: --adaptive needs --error or --seconds to stop at\n";
    parsed.exit_code = to_int(ExitCode::kUsage);
  }
  if (options.command == "accuracy" && used->count("--size") == 0) {
    options.picture.request.width = 160;
    options.picture.request.height = 120;
  }
  options.picture.request.camera = camera_choice(options.picture.camera);
  if (!apply_crop(options)) {
    std::cerr << "raykiln: --crop leaves the picture of --size\n";
    parsed.exit_code = to_int(ExitCode::kUsage);
  }
  if (!layers_have_a_file(options)) {
    std::cerr << "raykiln: --layers go into an .exr of floats: name one with -o, without --half\n";
    parsed.exit_code = to_int(ExitCode::kUsage);
  }
  for (const auto& output : options.outputs) {
    if (output.extension() == ".exr" || output.extension() == ".png") continue;
    std::cerr << "raykiln: " << output << ": a picture file ends in .exr or .png\n";
    parsed.exit_code = to_int(ExitCode::kUsage);
  }
  return parsed;
}

ExitCode run_cli(const CliOptions& options) {
  if (options.command == "render") return render_command(options);
  if (options.command == "lint") return lint_command(options);
  if (options.command == "effects") return effects_command(options);
  if (options.command == "accuracy") return accuracy_command(options);
  if (options.command == "replay") return replay_command(options);
  if (options.command == "compare") return compare_command(options);
  if (options.command == "batch") return batch_command(options);
  if (options.command == "approve") return approve_command(options);
  if (options.command == "selftest") return selftest_command(options);
  if (options.command == "submit") return submit_command(options);
  if (options.command == "extend") return extend_command(options);
  if (options.command == "quote") return quote_command(options);
  if (options.command == "watch") return watch_command(options);
  if (options.command == "fetch") return fetch_command(options);
  if (options.command == "cancel") return cancel_command(options);
  if (options.command == "scenes") return scenes_command(options);
  if (options.command == "jobs") return jobs_command(options);
  return health_command(options);
}

}  // namespace raykiln::server
