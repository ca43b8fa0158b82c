#include "raykiln/api/job_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace raykiln::server {
namespace {

using nlohmann::json;

const std::string kScene(64, 'a');

json smallest() {
  return {{"scene", kScene}, {"width", 64}, {"height", 48}, {"stop", {{"samples", 4}}}};
}

/// "pointer code" of each wrong field; empty when the request is taken.
std::vector<std::string> errors_of(const std::string& body) {
  const auto parsed = parse_job_request(body, JobLimits{});
  std::vector<std::string> list;
  if (const auto* problem = std::get_if<Problem>(&parsed)) {
    for (const auto& error : problem->errors) list.push_back(error.pointer + ' ' + error.code);
    if (list.empty()) list.push_back(problem->code);
  }
  return list;
}

TEST(JobRequestJson, FillsDefaults) {
  const auto parsed = parse_job_request(smallest().dump(), JobLimits{});
  const auto* request = std::get_if<JobRequest>(&parsed);
  ASSERT_NE(request, nullptr);
  EXPECT_EQ(request->width, 64);
  EXPECT_EQ(request->stop.samples, 4U);
  EXPECT_EQ(request->max_depth, std::nullopt);
  EXPECT_EQ(depth_limit(*request), 1024);
  EXPECT_EQ(request->light_model, LightModel::kPhysical);
  EXPECT_EQ(request->tile, 64);
  EXPECT_EQ(request->priority, 10);
  EXPECT_EQ(std::get<int>(request->camera), 0);
}

TEST(JobRequestJson, ComesBackAsItWent) {
  JobRequest request;
  request.scene = kScene;
  request.name = "n\xC3\xA4me";
  request.camera = OwnCamera{{1, 2, 3}, {0, 0.5, -1e-3}, {0, 0, 1}, 33.5};
  request.width = 16384;
  request.height = 1;
  request.stop.samples = 1048576;
  request.max_depth = 0;
  request.seed = 9007199254740991U;
  request.priority = 100;
  request.pixel_mode = PixelMode::kCentre;
  request.direction_sampling = DirectionSampling::kUniformSphere;
  request.emitter_sampling = false;
  request.sampler = Sampler::kSobol;
  request.emitter_choice = EmitterChoice::kTree;
  request.texture_filter = TextureFilter::kFootprint;
  request.tree.references_per_triangle = 1.1;
  request.tree.max_bytes = 9007199254740991U;
  request.lens = Lens{0.25, 3.0};
  request.crop = Crop{1, 2, 16384, 16384};
  request.effects = "without=refraction,roulette";
  request.layers = "albedo,depth,indirect";
  request.light_model = LightModel::kSeed;
  request.light_model_overrides = {PhongDivisor::kMax, FresnelFormula::kSchlick, false, std::nullopt, true};
  request.adaptive = true;
  request.tile = kAdaptiveTile;
  for (const CameraChoice& camera : {CameraChoice{7}, CameraChoice{std::string("front")}, request.camera}) {
    request.camera = camera;
    const auto text = job_request_json(request);
    const auto parsed = parse_job_request(text, JobLimits{});
    ASSERT_TRUE(std::holds_alternative<JobRequest>(parsed)) << text;
    EXPECT_EQ(job_request_json(std::get<JobRequest>(parsed)), text);
  }
}

TEST(JobRequestJson, NamesEveryWrongField) {
  const auto check = [](const char* field, const json& value, const std::string& wanted) {
    json body = smallest();
    body[json::json_pointer(field)] = value;
    EXPECT_EQ(errors_of(body.dump()), std::vector<std::string>{wanted}) << field << ' ' << value;
  };
  check("/width", 0, "/width out_of_range");
  check("/width", 16385, "/width out_of_range");
  check("/width", -1, "/width out_of_range");
  check("/width", 1.5, "/width wrong_type");
  check("/width", 1e300, "/width out_of_range");
  check("/width", "64", "/width wrong_type");
  check("/width", nullptr, "/width wrong_type");
  check("/scene", "xyz", "/scene invalid_value");
  check("/stop", 4, "/stop wrong_type");
  check("/stop/time", 4, "/stop/time unknown_field");
  check("/stop/samples", 0, "/stop/samples out_of_range");
  check("/a~1b", 4, "/a~1b unknown_field");
  check("/light_model", "nature", "/light_model invalid_value");
  check("/light_model_overrides", true, "/light_model_overrides wrong_type");
  check("/light_model_overrides", {{"phong", "half"}}, "/light_model_overrides/phong invalid_value");
  check("/light_model_overrides", {{"roulette", 1}}, "/light_model_overrides/roulette wrong_type");
  check("/light_model_overrides", {{"x", 1}}, "/light_model_overrides/x unknown_field");
  check("/name", std::string(201, 'a'), "/name out_of_range");
  check("/name", "a\nb", "/name invalid_value");
  check("/seed", 9007199254740992U, "/seed out_of_range");
  check("/camera", json::array(), "/camera wrong_type");
  check("/camera", -1, "/camera out_of_range");
  check("/camera", {{"eye", {0, 0, 0}}}, "/camera/look_at missing_field");
  check("/camera", {{"eye", {0, 0}}, {"look_at", {0, 0, 0}}}, "/camera/eye wrong_type");
  check("/camera", {{"eye", {0, 0, 0}}, {"look_at", {0, 0, 1}}, {"fov_deg", 180}}, "/camera/fov_deg out_of_range");
  check("/emitter_sampling", 1, "/emitter_sampling wrong_type");
  check("/sampler", "halton", "/sampler invalid_value");
  check("/adaptive", "yes", "/adaptive wrong_type");
  check("/emitter_choice", "luck", "/emitter_choice invalid_value");
  check("/texture_filter", "mip", "/texture_filter invalid_value");
  check("/filter", "gauss", "/filter invalid_value");
  check("/lens", 0.1, "/lens wrong_type");
  check("/lens", {{"radius", 0.1}}, "/lens/focus_distance missing_field");
  check("/lens", {{"focus_distance", 1}}, "/lens/radius missing_field");
  check("/crop", json::array(), "/crop wrong_type");
  check("/crop", {{"x", 0}, {"y", 0}, {"full_width", 640}}, "/crop/full_height missing_field");
  check("/camera", {{"eye", {0, 0, 0}}, {"look_at", {0, 0, 1}}, {"fov_deg", 40}, {"view_height", 1}},
        "/camera/view_height invalid_value");
  check("/tree", 4, "/tree wrong_type");
  check("/tree", {{"references", 4}}, "/tree/references unknown_field");
  check("/tree", {{"references_per_triangle", 0.5}}, "/tree/references_per_triangle out_of_range");
  check("/tree", {{"references_per_triangle", 65}}, "/tree/references_per_triangle out_of_range");
  check("/tree", {{"references_per_triangle", "4"}}, "/tree/references_per_triangle wrong_type");
  check("/tree", {{"max_bytes", 0}}, "/tree/max_bytes out_of_range");
  check("/tree", {{"max_bytes", -5}}, "/tree/max_bytes out_of_range");
  check("/tree", {{"max_bytes", 1.5}}, "/tree/max_bytes wrong_type");
  check("/tree", {{"max_bytes", 9007199254740992U}}, "/tree/max_bytes out_of_range");
  check("/tree", {{"max_bytes", nullptr}}, "/tree/max_bytes wrong_type");
  check("/layers", "albedo", "/layers wrong_type");
  check("/layers", {"albedo", "beauty"}, "/layers/1 invalid_value");
  check("/layers", {"albedo", 7}, "/layers/1 invalid_value");
  check("/layers", {"depth", "depth"}, "/layers/1 invalid_value");
  check("/layers", std::vector<std::string>(9, "depth"), "/layers wrong_type");
  check("/effects", "none", "/effects invalid_value");
  check("/effects", "without=refraction", "/effects invalid_value");
  check("/effects", 3, "/effects wrong_type");
  check("/effects", nullptr, "/effects wrong_type");
  check("/effects", json::object(), "/effects/without missing_field");
  check("/effects", {{"without", {"refraction"}}, {"with", 1}}, "/effects/with unknown_field");
  check("/effects", {{"without", json::array()}}, "/effects/without wrong_type");
  check("/effects", {{"without", "refraction"}}, "/effects/without wrong_type");
  check("/effects", {{"without", std::vector<std::string>(50, "fresnel")}}, "/effects/without wrong_type");
  check("/effects", {{"without", {"refraction", "moire"}}}, "/effects/without/1 invalid_value");
  check("/effects", {{"without", {"refraction", 7}}}, "/effects/without/1 invalid_value");
  check("/effects", {{"without", {"fresnel", "fresnel"}}}, "/effects/without/1 invalid_value");
  EXPECT_EQ(errors_of("{}").size(), 4U);
}

TEST(Extension, TakesAStopWithoutTilesAndNothingElse) {
  const auto whole = parse_extension(R"({"stop": {"samples": 9, "seconds": 2, "error": 0.5}, "priority": 3})", JobLimits{});
  const auto* extension = std::get_if<Extension>(&whole);
  ASSERT_NE(extension, nullptr);
  EXPECT_EQ(extension->stop.samples, 9U);
  EXPECT_EQ(extension->priority, 3);
  for (const auto& [body, pointer] : {std::pair{R"({"stop": {"samples": 9, "tile_samples": [1]}})", "/stop/tile_samples"},
                                      {R"({"stop": {"tile_samples": [1]}})", "/stop/tile_samples"},
                                      {R"({"stop": {}})", "/stop"},
                                      {R"({"priority": 3})", "/stop"},
                                      {R"({"stop": {"samples": 9}, "reuse": true})", "/reuse"}}) {
    const auto refused = parse_extension(body, JobLimits{});
    const auto* problem = std::get_if<Problem>(&refused);
    ASSERT_NE(problem, nullptr) << body;
    EXPECT_EQ(problem->errors.front().pointer, pointer) << body;
  }
}

TEST(JobRequestJson, EffectsHaveOneSpelling) {
  const auto effects_of = [](const json& value) {
    json body = smallest();
    body["effects"] = value;
    const auto parsed = parse_job_request(body.dump(), JobLimits{});
    return std::get_if<JobRequest>(&parsed)->effects;
  };
  const JobRequest plain;
  EXPECT_EQ(effects_of("auto"), plain.effects);
  EXPECT_EQ(effects_of("all"), "all");
  EXPECT_EQ(effects_of({{"without", {"roulette", "refraction"}}}), "without=refraction,roulette");
}

TEST(JobRequestJson, AnUnknownEffectIsAnsweredWithThoseThatThereAre) {
  json body = smallest();
  body["effects"] = {{"without", {"moire"}}};
  const auto parsed = parse_job_request(body.dump(), JobLimits{});
  const auto& problem = std::get<Problem>(parsed);
  EXPECT_EQ(problem.status, 422);
  for (const char* name : {"refraction", "point_lights", "roulette"}) {
    EXPECT_NE(problem.errors.at(0).detail.find(name), std::string::npos) << problem.errors[0].detail;
  }
}

TEST(JobRequestJson, TakesWholeNumbersThatAreWrittenWithAPoint) {
  json body = smallest();
  body["width"] = 64.0;
  EXPECT_TRUE(errors_of(body.dump()).empty());
}

TEST(JobRequestJson, RefusesWhatIsNoJson) {
  for (const std::string text : {"", "{", "nul", "{}{}", "{\"a\":1,}", "\xFF", "NaN"}) {
    EXPECT_EQ(errors_of(text), std::vector<std::string>{"invalid_json"}) << text;
  }
  EXPECT_EQ(errors_of("[]"), std::vector<std::string>{" wrong_type"});
  EXPECT_EQ(errors_of(std::string(50000, '[')), std::vector<std::string>{"invalid_json"});
  const auto twice = errors_of("{\"width\":1,\"width\":2," + smallest().dump().substr(1));
  EXPECT_EQ(twice.front(), "/width duplicate_field");
}

EffectReport draft_report() {
  return {"without=refraction (refraction bounded)",
          {{"refraction", true, false, "material `glass`: transparent 1", "bounded", "refracted directions"},
           {"background", true, true, "background 1 1 1", "", ""}}};
}

TEST(JobJson, SaysWhatIsSimulatedAndWhy) {
  JobSnapshot job;
  EXPECT_EQ(json::parse(job_json(job))["effects"], nullptr);
  EXPECT_EQ(parse_job_view(job_json(job))->approximation, "");
  job.effects = draft_report();
  const json effects = json::parse(job_json(job))["effects"];
  EXPECT_EQ(effects["approximation"], true);
  EXPECT_EQ(effects["list"][0],
            (json{{"effect", "refraction"},
                  {"called_for", true},
                  {"simulated", false},
                  {"evidence", "material `glass`: transparent 1"},
                  {"grade", "bounded"},
                  {"left_out", "refracted directions"}}));
  EXPECT_EQ(parse_job_view(job_json(job))->approximation, "without=refraction (refraction bounded)");
}

JobSnapshot snapshot() {
  JobSnapshot job;
  job.id = "j_1";
  job.request.scene = kScene;
  job.state = JobState::kRendering;
  job.revision = 9;
  job.image_revision = 7;
  job.progress.samples_done = 50;
  job.progress.samples_target = 100;
  job.progress.samples_per_pixel = 2.0;
  job.remaining_seconds = 1.5;
  job.created = WallTime(std::chrono::milliseconds(1500));
  return job;
}

TEST(JobJson, IsReadBackByClients) {
  const auto view = parse_job_view(job_json(snapshot()));
  ASSERT_TRUE(view);
  EXPECT_EQ(view->id, "j_1");
  EXPECT_EQ(view->state, "rendering");
  EXPECT_EQ(view->revision, 9U);
  EXPECT_DOUBLE_EQ(view->fraction, 0.5);
  EXPECT_EQ(view->remaining_seconds, 1.5);
  EXPECT_TRUE(view->has_image);
  EXPECT_TRUE(view->error.empty());
}

TEST(JobJson, TellsClientsHowItEnded) {
  auto job = snapshot();
  EXPECT_FALSE(parse_job_view(job_json(job))->accuracy);
  job.done_by = DoneBy::kSeconds;
  job.request.stop.error = 0.01;
  job.warnings = {{"code", "what", "where"}, {"code", "what else", ""}};
  job.accuracy.emplace();
  job.accuracy->notices = {"heavy_tailed", "of_tomorrow"};
  auto view = parse_job_view(job_json(job));
  ASSERT_TRUE(view && view->accuracy);
  EXPECT_FALSE(view->accuracy->known());
  job.accuracy->grade = "measured";
  job.accuracy->error = {0.02, 0.01, 0.03};
  view = parse_job_view(job_json(job));
  EXPECT_TRUE(view->accuracy->known());
  EXPECT_EQ(view->accuracy->error.high, 0.03);
  EXPECT_EQ(view->accuracy->notices, job.accuracy->notices);
  EXPECT_EQ(view->done_by, DoneBy::kSeconds);
  EXPECT_EQ(view->target, 0.01);
  EXPECT_FALSE(view->target_reached);
  EXPECT_EQ(view->warnings, (std::vector<std::string>{"what (where)", "what else"}));
  const auto remarks = json::parse(job_json(job))["accuracy"]["remarks"];
  ASSERT_EQ(remarks.size(), 2U);
  EXPECT_EQ(remarks[0], remark("heavy_tailed"));
  EXPECT_EQ(remarks[1], "of_tomorrow");
}

TEST(JobJson, FollowsTheContract) {
  auto job = snapshot();
  auto value = json::parse(job_json(job));
  EXPECT_EQ(value["created_at"], "1970-01-01T00:00:01.500Z");
  EXPECT_EQ(value["image"]["png"], "/v1/jobs/j_1/image?format=png&rev=7");
  EXPECT_TRUE(value["prepare"].is_null());
  EXPECT_TRUE(value["started_at"].is_null());
  EXPECT_EQ(value["request"]["tree"], (json{{"references_per_triangle", 4.0}}));
  for (const char* field : {"tree_references", "tree_bytes", "tree_peak_bytes", "tree_budget_reached"}) {
    EXPECT_TRUE(value["statistics"].at(field).is_null()) << field;
  }
  job.statistics.tree = TreeFigures{5, 6, 7, true};
  value = json::parse(job_json(job));
  EXPECT_EQ(value["statistics"]["tree_references"], 5);
  EXPECT_EQ(value["statistics"]["tree_bytes"], 6);
  EXPECT_EQ(value["statistics"]["tree_peak_bytes"], 7);
  EXPECT_EQ(value["statistics"]["tree_budget_reached"], true);
  job.state = JobState::kFailed;
  job.error = Error{ErrorKind::kInternal, "render_failed", "why", "where"};
  value = json::parse(job_json(job));
  EXPECT_EQ(value["error"]["code"], "render_failed");
  EXPECT_EQ(value["error"]["status"], 500);
  EXPECT_TRUE(value["remaining_seconds"].is_null());
  EXPECT_EQ(parse_job_view(job_json(job))->error, "render_failed: why (where)");
}

TEST(JobJson, NamesTheCommandThatReplaysABadSample) {
  auto job = snapshot();
  job.statistics.bad_samples = {{3, 4, 17}};
  auto bad = json::parse(job_json(job))["statistics"]["bad_samples"];
  EXPECT_EQ(bad[0]["replay"], "raykiln replay j_1 3 4 17");
  job.id.clear();  // a picture of the command line program
  bad = json::parse(job_json(job))["statistics"]["bad_samples"];
  EXPECT_EQ(bad[0]["replay"], "");
}

TEST(JobJson, IsOneLineEvenWithHostileText) {
  auto job = snapshot();
  job.request.name = "a\nb\r\xFF\xE2\x80\xA8";
  const auto text = job_json(job);
  EXPECT_EQ(text.find_first_of("\r\n"), std::string::npos);
  EXPECT_TRUE(parse_job_view(text));
}

TEST(JobJson, RefusesWhatIsNoJob) {
  EXPECT_FALSE(parse_job_view("{}"));
  EXPECT_FALSE(parse_job_view("not json"));
  EXPECT_FALSE(parse_job_page("{\"jobs\":[{}],\"next_cursor\":null}"));
  EXPECT_EQ(parse_job_page(job_page_json({snapshot()}, "c"))->next_cursor, "c");
}

}  // namespace
}  // namespace raykiln::server
