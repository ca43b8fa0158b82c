#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "raykiln/jobs/admission.hpp"
#include "raykiln/jobs/job_snapshot.hpp"

namespace raykiln::server {
namespace {

JobRequest good() {
  JobRequest request;
  request.scene = std::string(64, 'a');
  return request;
}

TEST(JobRequest, OneRangeOfReferencesForReaderAndRequest) {
  JobLimits limits;
  limits.max_tree_references = 8.0;
  EXPECT_FALSE(references_error(1.0, limits) || references_error(8.0, limits));
  for (const double wrong : {0.99, 8.01, -1.0, static_cast<double>(NAN)}) EXPECT_EQ(references_error(wrong, limits), "must be from 1 to 8");
  JobRequest request = good();
  request.tree.references_per_triangle = 9.0;
  EXPECT_EQ(validate(request, limits).error().message, "must be from 1 to 8");
}

TEST(JobRequest, IsCheckedAgainstEveryLimit) {
  EXPECT_TRUE(validate(good(), {}));
  const std::pair<const char*, void (*)(JobRequest&)> rows[] = {
      {"/scene", [](JobRequest& r) { r.scene = std::string(63, 'a'); }},
      {"/name", [](JobRequest& r) { r.name = std::string(1, '\n'); }},
      {"/name", [](JobRequest& r) { r.name = std::string(201, 'x'); }},
      {"/width", [](JobRequest& r) { r.width = 0; }},
      {"/height", [](JobRequest& r) { r.height = 1'000'000; }},
      {"/stop/samples", [](JobRequest& r) { r.stop.samples = 0; }},
      {"/max_depth", [](JobRequest& r) { r.max_depth = 1025; }},
      {"/branches", [](JobRequest& r) { r.branches = 16; }},
      {"/tile", [](JobRequest& r) { r.tile = 0; }},
      {"/tile", [](JobRequest& r) { r.tile = 1, r.width = 16'384, r.height = 16'384; }},
      {"/priority", [](JobRequest& r) { r.priority = 101; }},
      {"/adaptive", [](JobRequest& r) { r.adaptive = true, r.tile = kAdaptiveTile; }},
      {"/tile", [](JobRequest& r) { r.adaptive = true, r.stop.error = 0.1; }},
      {"/camera", [](JobRequest& r) { r.camera = -1; }},
      {"/camera", [](JobRequest& r) { r.camera = std::string(); }},
      {"/camera/look_at", [](JobRequest& r) { r.camera = OwnCamera{}; }},
      {"/camera/up", [](JobRequest& r) { r.camera = OwnCamera{{}, {0, 2, 0}, {0, 1, 0}, 40}; }},
      {"/camera/eye", [](JobRequest& r) { r.camera = OwnCamera{{NAN, 0, 0}, {0, 0, 1}, {0, 1, 0}, 40}; }},
      {"/camera/fov_deg", [](JobRequest& r) { r.camera = OwnCamera{{}, {0, 0, 1}, {0, 1, 0}, NAN}; }},
      {"/camera/view_height", [](JobRequest& r) { r.camera = OwnCamera{{}, {0, 0, 1}, {0, 1, 0}, 40, -1.0}; }},
      {"/lens/radius", [](JobRequest& r) { r.lens = Lens{-1.0, 1.0}; }},
      {"/lens/focus_distance", [](JobRequest& r) { r.lens = Lens{1.0, NAN}; }},
      {"/crop/x", [](JobRequest& r) { r.crop = Crop{1, 0, r.width, r.height}; }},
      {"/crop/y", [](JobRequest& r) { r.crop = Crop{0, -1, r.width, r.height}; }},
      {"/crop/full_width", [](JobRequest& r) { r.crop = Crop{0, 0, 1'000'000, r.height}; }},
      {"/tree/references_per_triangle", [](JobRequest& r) { r.tree.references_per_triangle = 0.99; }},
      {"/tree/references_per_triangle", [](JobRequest& r) { r.tree.references_per_triangle = 64.5; }},
      {"/tree/references_per_triangle", [](JobRequest& r) { r.tree.references_per_triangle = NAN; }},
      {"/tree/max_bytes", [](JobRequest& r) { r.tree.max_bytes = 0; }},
      {"/tree/max_bytes", [](JobRequest& r) { r.tree.max_bytes = std::uint64_t{1} << 53; }},
      {"/filter", [](JobRequest& r) { r.filter = PixelFilter::kBlackmanHarris, r.pixel_mode = PixelMode::kCentre; }},
  };
  for (const auto& [where, spoil] : rows) {
    JobRequest request = good();
    spoil(request);
    const Status status = validate(request, {});
    ASSERT_FALSE(status) << where;
    EXPECT_EQ(status.error().where, where);
    EXPECT_EQ(status.error().code, "invalid_request");
  }
}

TEST(JobRequest, DigestTellsRequestsApart) {
  JobRequest other = good();
  EXPECT_EQ(request_digest(good()), request_digest(other));
  other.seed = 1;
  EXPECT_NE(request_digest(good()), request_digest(other));
  other = good();
  other.layers = "albedo";
  EXPECT_NE(request_digest(good()), request_digest(other));
  EXPECT_NE(result_digest(good(), ""), result_digest(other, ""));
  JobSnapshot kept;
  kept.id = "j_1";
  kept.request = other;
  EXPECT_EQ(decode_job(encode_job(kept))->request.layers, "albedo");
  other = good();
  other.camera = std::string("0");
  EXPECT_NE(request_digest(good()), request_digest(other)) << "a name is not an index";
}

TEST(JobRecord, OfAnOlderVersionHasTheDefaultEffects) {
  JobSnapshot job;
  job.id = "j_1";
  job.request = good();
  std::string text = encode_job(job);
  ASSERT_EQ(text.find("effect"), std::string::npos);
  EXPECT_EQ(decode_job(text)->request.effects, "auto");
  EXPECT_TRUE(decode_job(text)->effects.lines.empty());
  ASSERT_EQ(text.find("tree"), std::string::npos);
  EXPECT_EQ(decode_job(text)->request.tree, TreeBudget{});
  EXPECT_FALSE(decode_job(text)->statistics.tree);
}

TEST(JobRequest, BudgetsOfTreesHaveATextOfTheirOwn) {
  const auto text = [](double references, std::optional<std::uint64_t> bytes) {
    TreeBudget tree;
    tree.references_per_triangle = references;
    tree.max_bytes = bytes;
    return tree_budget_text(tree);
  };
  EXPECT_EQ(text(4.0, std::nullopt), "4");
  EXPECT_EQ(text(4.0, 1'000'000), "4 1000000");
  EXPECT_NE(text(1.1, std::nullopt), text(std::nextafter(1.1, 2.0), std::nullopt));
}

TEST(JobRequest, ResultDigestLeavesOutWhatChangesNoPicture) {
  const std::string digest = result_digest(good(), "engine");
  JobRequest same = good();
  same.name = "another";
  same.priority = 99;
  same.reuse = true;
  EXPECT_EQ(result_digest(same, "engine"), digest);
  EXPECT_NE(result_digest(good(), "another engine"), digest);
  const std::function<void(JobRequest&)> changes[] = {
      [](JobRequest& r) { r.scene.front() = r.scene.front() == '0' ? '1' : '0'; },
      [](JobRequest& r) { r.camera = 1; },
      [](JobRequest& r) { ++r.width; },
      [](JobRequest& r) { ++r.stop.samples; },
      [](JobRequest& r) { r.stop.seconds = 1.0; },
      [](JobRequest& r) { r.stop.error = 0.5; },
      [](JobRequest& r) { r.light_model = LightModel::kSeed; },
      [](JobRequest& r) { r.light_model_overrides.roulette = false; },
      [](JobRequest& r) { r.max_depth = 1; },
      [](JobRequest& r) { ++r.seed; },
      [](JobRequest& r) { r.emitter_sampling = !r.emitter_sampling; },
      [](JobRequest& r) { r.sampler = Sampler::kSobol; },
      [](JobRequest& r) { r.adaptive = true; },
      [](JobRequest& r) { r.filter = PixelFilter::kBlackmanHarris; },
      [](JobRequest& r) { r.emitter_choice = EmitterChoice::kTree; },
      [](JobRequest& r) { r.texture_filter = TextureFilter::kFootprint; },
      [](JobRequest& r) { r.tree.references_per_triangle = 2.0; },
      [](JobRequest& r) { r.tree.max_bytes = 4; },
      [](JobRequest& r) { r.lens = Lens{0.0, 1.0}; },
      [](JobRequest& r) { r.crop = Crop{0, 0, r.width, r.height}; }};
  for (const auto& change : changes) {
    JobRequest other = good();
    change(other);
    EXPECT_NE(result_digest(other, "engine"), digest) << &change - changes;
  }
}

TEST(JobRecord, ReadsBack) {
  JobSnapshot job;
  job.id = "j_1";
  job.request = good();
  job.request.name = "two words\\";
  job.request.lens = Lens{0.05, 2.5};
  job.request.crop = Crop{3, 4, 1000, 2000};
  job.request.filter = PixelFilter::kBlackmanHarris;
  job.request.emitter_choice = EmitterChoice::kPower;
  job.request.texture_filter = TextureFilter::kFootprint;
  job.request.tree.references_per_triangle = 1.1;
  job.request.tree.max_bytes = 9007199254740991U;
  job.statistics.tree = TreeFigures{5, 6, 7, true};
  job.request.camera = OwnCamera{{0.1, 2, 3}, {4, 5, 6}, {0, 0, 1}, 33.3, 7.5};
  job.request.seed = (1ULL << 53) - 1;
  job.request.reuse = true;
  job.request.adaptive = true;
  job.request.sampler = Sampler::kSobol;
  job.state = JobState::kFailed;
  job.revision = 12;
  job.image_revision = 12;
  job.created = WallTime(std::chrono::milliseconds(1'700'000'000'123));
  job.started = job.created;
  job.statistics.bad_samples = {{1, 2, 3}, {4, 5, 6}};
  job.statistics.idle_seconds = 0.1;
  job.statistics.roulette_ends = 5;
  job.statistics.lights_at_hits = 6;
  job.statistics.short_stream_calls = 7;
  job.statistics.traversal_seconds = 0.25;
  job.progress.samples_done = 99;
  job.warnings = {{"a", "b", "c"}, {"d", "", ""}};
  job.error = Error{ErrorKind::kInternal, "render_failed", "why", "where"};
  job.request.effects = "without=refraction";
  job.effects = {"without=refraction (refraction bounded)",
                 {{"refraction", true, false, "material `a\nb`: transparent 1", "bounded", "code"},
                  {"mirrors", false, false, "none", "identical", "mirror lobes"}}};
  const auto back = decode_job(encode_job(job));
  ASSERT_TRUE(back);
  EXPECT_EQ(encode_job(*back), encode_job(job));
  EXPECT_EQ(request_digest(back->request), request_digest(job.request));
  EXPECT_EQ(back->request.effects, "without=refraction");
  EXPECT_EQ(back->effects.label, job.effects.label);
  EXPECT_EQ(back->effects.lines.at(0).evidence, "material `a\nb`: transparent 1");
  EXPECT_TRUE(back->effects.lines.at(0).called_for && !back->effects.lines.at(0).simulated);
  EXPECT_TRUE(is_approximation(back->effects));
  EXPECT_EQ(back->effects.lines.at(1).left_out, "mirror lobes");
  EXPECT_TRUE(back->request.reuse);
  EXPECT_EQ(back->request.tree, job.request.tree);
  ASSERT_TRUE(back->statistics.tree);
  EXPECT_EQ(back->statistics.tree->references, 5U);
  EXPECT_EQ(back->statistics.tree->bytes, 6U);
  EXPECT_EQ(back->statistics.tree->peak_bytes, 7U);
  EXPECT_TRUE(back->statistics.tree->budget_reached);
  EXPECT_EQ(back->error->message, "why");
  EXPECT_EQ(back->statistics.bad_samples.at(1).sample, 6U);
  EXPECT_EQ(back->statistics.roulette_ends, 5U);
  EXPECT_EQ(back->statistics.lights_at_hits, 6U);
  EXPECT_EQ(back->statistics.short_stream_calls, 7U);
  EXPECT_EQ(back->statistics.traversal_seconds, 0.25);
  EXPECT_FALSE(back->finished);
  EXPECT_FALSE(decode_job("rubbish"));
}

TEST(Admission, SaysWhenToComeBack) {
  EXPECT_TRUE(admit(9, 10, 60.0, 1));
  const Status full = admit(10, 10, 60.0, 3);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().kind, ErrorKind::kTooMany);
  EXPECT_EQ(full.error().retry_after_s, 20);
  EXPECT_EQ(admit(10, 10, 0.0, 0).error().retry_after_s, 1);
  EXPECT_EQ(admit(10, 10, 1e9, 1).error().retry_after_s, 600);
}

TEST(LightModelOverrides, TextComesBackAsItWent) {
  for (const char* text : {"", "phong=max", "phong=over_cos_o,fresnel=schlick,radiance_scaling=false,diffuse_sampling=uniform,roulette=false",
                           "fresnel=exact,roulette=true"}) {
    const auto overrides = overrides_of(text);
    ASSERT_TRUE(overrides.has_value()) << text;
    EXPECT_EQ(overrides_text(*overrides), text);
  }
  for (const char* text : {"phong", "phong=", "phong=half", "colour=max", "roulette=1", ",", "phong=max,,"}) {
    EXPECT_FALSE(overrides_of(text).has_value()) << text;
  }
  EXPECT_EQ(light_model_label(LightModel::kPhysical, {}), "physical");
  EXPECT_EQ(light_model_label(LightModel::kSeed, *overrides_of("roulette=true")), "seed with roulette=true");
}

TEST(LightModelOverrides, DecideTheDepthThatIsNotGiven) {
  JobRequest request;
  EXPECT_EQ(depth_limit(request), 1024);
  request.light_model_overrides.roulette = false;
  EXPECT_EQ(depth_limit(request), 8);
  request.light_model = LightModel::kSeed;
  request.light_model_overrides.roulette = true;
  EXPECT_EQ(depth_limit(request), 1024);
  request.branches = 2;
  EXPECT_EQ(depth_limit(request), 8);
  request.max_depth = 0;
  EXPECT_EQ(depth_limit(request), 0);
}

}  // namespace
}  // namespace raykiln::server
