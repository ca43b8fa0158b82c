#include <gtest/gtest.h>

#include "raykiln/app/cli.hpp"
#include "raykiln/app/daemon.hpp"

namespace raykiln::server {
namespace {

ParsedDaemon daemon(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "raykilnd");
  return parse_daemon_options(static_cast<int>(arguments.size()), arguments.data());
}

ParsedCli cli(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "raykiln");
  return parse_cli_options(static_cast<int>(arguments.size()), arguments.data());
}

TEST(DaemonOptions, ReadsAddresses) {
  EXPECT_EQ(daemon({}).options.config.http.port, 8080);
  const auto v6 = daemon({"--listen", "[::1]:0"});
  EXPECT_EQ(v6.options.config.http.address, "::1");
  EXPECT_EQ(v6.options.config.http.port, 0);
  EXPECT_EQ(daemon({"--listen", "9000"}).options.config.http.port, 9000);
}

TEST(DaemonOptions, RefusesOtherMachinesUnlessTold) {
  EXPECT_EQ(daemon({"--listen", "0.0.0.0:8080"}).exit_code, 2);
  EXPECT_EQ(daemon({"--listen", "0.0.0.0:8080", "--allow-remote"}).exit_code, -1);
}

TEST(DaemonOptions, RefusesNonsense) {
  for (const char* text : {"127.0.0.1", "127.0.0.1:x", "127.0.0.1:70000", ":"}) {
    EXPECT_EQ(daemon({"--listen", text}).exit_code, 2) << text;
  }
  EXPECT_EQ(daemon({"--unknown"}).exit_code, 2);
  EXPECT_EQ(daemon({"--look-share", "1.5"}).exit_code, 2);
  EXPECT_EQ(daemon({"--look-share", "0"}).options.config.scheduler.look_share, 0.0);
  EXPECT_EQ(daemon({"--cache-bytes", "512MB"}).options.config.workers.scene_cache_bytes, 512U << 20U);
  EXPECT_EQ(daemon({}).options.config.workers.wide_tree_bytes, kGiB);
  EXPECT_EQ(daemon({"--wide-tree-bytes", "300MB"}).options.config.workers.wide_tree_bytes, 300U << 20U);
  for (const char* wrong : {"0", "-1", "9007199254740992", "much"}) EXPECT_EQ(daemon({"--wide-tree-bytes", wrong}).exit_code, 2) << wrong;
}

TEST(CliOptions, ABatchIsLocalOrWaitedForAgain) {
  EXPECT_EQ(cli({"batch", "a.yaml"}).exit_code, -1);
  EXPECT_EQ(cli({"batch", "a.yaml", "--local", "--resume", "b_1"}).exit_code, 2);
  EXPECT_EQ(cli({"batch", "a.yaml", "--rerun"}).exit_code, 2) << "of which batch?";
  const auto again = cli({"batch", "a.yaml", "--resume", "b_1", "--rerun", "--timeout", "2.5", "--cancel-on-interrupt"});
  EXPECT_EQ(again.exit_code, -1);
  EXPECT_EQ(again.options.batch.resume, "b_1");
  EXPECT_EQ(again.options.batch.timeout_seconds, 2.5);
  EXPECT_TRUE(again.options.batch.cancel_on_interrupt);
}

TEST(CliOptions, ReadsLayersForWhatCanHoldThem) {
  const auto read = cli({"render", "a.obj", "-o", "a.exr", "--layers", "direct,albedo"});
  EXPECT_EQ(read.exit_code, -1);
  EXPECT_EQ(read.options.picture.request.layers, "albedo,direct");
  EXPECT_EQ(cli({"submit", "a.obj", "--layers", "depth"}).exit_code, -1);
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.exr", "--layers", "albedo,beauty"}).exit_code, 2);
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", "--layers", "albedo"}).exit_code, 2) << "a PNG holds none";
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.exr", "--half", "--layers", "albedo"}).exit_code, 2);
}

TEST(CliOptions, ALensHasARadiusAndADistance) {
  const auto lens = cli({"render", "a.obj", "-o", "a.png", "--lens", "0.05,2"}).options.picture.request.lens;
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->radius, 0.05);
  EXPECT_EQ(lens->focus_distance, 2.0);
  for (const char* wrong : {"0.1", "0.1,", "0.1,0", "-1,2", "a,b", "1,2,3", "nan,1", "1,inf"}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", "--lens", wrong}).exit_code, 2) << wrong;
    EXPECT_NE(testing::internal::GetCapturedStderr().find("RADIUS,FOCUS_DISTANCE"), std::string::npos) << wrong;
  }
}

TEST(CliOptions, ATreeHasABudget) {
  const auto usual = cli({"render", "a.obj", "-o", "a.png"}).options.picture.request.tree;
  EXPECT_EQ(usual, TreeBudget{});
  for (const char* command : {"render", "submit", "quote"}) {
    std::vector<const char*> words{command, "a.obj", "--tree-references", "1.5", "--tree-bytes", "500MB"};
    if (command == std::string("render")) words.insert(words.end(), {"-o", "a.png"});
    const auto tree = cli(words).options.picture.request.tree;
    EXPECT_EQ(tree.references_per_triangle, 1.5) << command;
    EXPECT_EQ(tree.max_bytes, 500'000'000U) << command;
  }
  for (const auto& [option, wrong] : {std::pair{"--tree-references", "0.9"}, {"--tree-references", "65"},
                                     {"--tree-bytes", "0"}, {"--tree-bytes", "-1"},
                                     {"--tree-bytes", "9007199254740992"}, {"--tree-bytes", "5 apples"}}) {
    testing::internal::CaptureStderr();
    EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", option, wrong}).exit_code, 2) << option << ' ' << wrong;
    EXPECT_NE(testing::internal::GetCapturedStderr(), "");
  }
}

TEST(CliOptions, ReadsStops) {
  const auto stop_of = [](std::vector<const char*> more) {
    std::vector<const char*> all{"render", "a.obj", "-o", "a.png"};
    all.insert(all.end(), more.begin(), more.end());
    return cli(all).options.picture.request.stop;
  };
  EXPECT_EQ(stop_of({}).samples, 64U);
  EXPECT_EQ(stop_of({"--seconds", "2.5"}).samples, JobLimits{}.max_samples);
  EXPECT_EQ(stop_of({"--seconds", "2.5"}).seconds, 2.5);
  EXPECT_EQ(stop_of({"--seconds", "2.5", "--samples", "9"}).samples, 9U);
  EXPECT_DOUBLE_EQ(*stop_of({"--error", "2%"}).error, 0.02);
  EXPECT_DOUBLE_EQ(*stop_of({"--error", "0.5"}).error, 0.5);
  EXPECT_EQ(stop_of({"--error", "2%"}).seconds, kDefaultErrorSeconds);
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", "--error", "little"}).exit_code, 2);
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", "--seconds", "0"}).exit_code, 2);
}

TEST(CliOptions, ReadsEffects) {
  const auto parsed = cli({"effects", "a.obj", "--effects", "without=roulette,refraction"});
  ASSERT_EQ(parsed.exit_code, -1);
  EXPECT_EQ(parsed.options.picture.request.effects, "without=refraction,roulette");
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", "--effects", "all"}).options.picture.request.effects, "all");
  EXPECT_EQ(cli({"submit", "a.obj", "--effects", "all"}).options.picture.request.effects, "all");
  EXPECT_EQ(cli({"render", "a.obj", "-o", "a.png", "--effects", "some"}).exit_code, 2);
}

TEST(CliOptions, ReadsRender) {
  const auto parsed = cli({"render", "a.obj", "-o", "a.exr", "-o", "a.png", "--size", "320x200", "--samples", "7",
                           "--camera", "2", "--threads", "3"});
  ASSERT_EQ(parsed.exit_code, -1);
  EXPECT_EQ(parsed.options.command, "render");
  EXPECT_EQ(parsed.options.outputs.size(), 2U);
  EXPECT_EQ(parsed.options.picture.request.width, 320);
  EXPECT_EQ(parsed.options.picture.request.height, 200);
  EXPECT_EQ(parsed.options.picture.request.stop.samples, 7U);
  EXPECT_EQ(std::get<int>(parsed.options.picture.request.camera), 2);
  EXPECT_EQ(std::get<std::string>(cli({"submit", "a.obj", "--camera", "2nd"}).options.picture.request.camera), "2nd");
}

TEST(CliOptions, ReadsCompare) {
  const auto parsed = cli({"compare", "a.exr", "b.exr", "--false-alarms", "0.05", "--z-map", "z.png"});
  ASSERT_EQ(parsed.exit_code, -1);
  EXPECT_EQ(parsed.options.compare.reference, "b.exr");
  EXPECT_EQ(parsed.options.compare.z_map, "z.png");
  EXPECT_DOUBLE_EQ(parsed.options.compare.settings.noise.false_alarms, 0.05);
  EXPECT_FALSE(parsed.options.compare.settings.use_thresholds);
}

TEST(CliOptions, UsageErrorsAreTwo) {
  const std::vector<std::vector<const char*>> rows = {
      {}, {"paint"}, {"render"}, {"render", "a.obj"}, {"render", "a.obj", "-o", "a.jpg"},
      {"render", "a.obj", "-o", "a.exr", "--size", "320"}, {"render", "a.obj", "-o", "a.exr", "--samples", "0"},
      {"watch"}, {"compare", "a.exr"}, {"compare", "a.exr", "b.exr", "--false-alarms", "2"}};
  for (const auto& row : rows) EXPECT_EQ(cli(row).exit_code, 2);
  EXPECT_EQ(cli({"--help"}).exit_code, 0);
}

}  // namespace
}  // namespace raykiln::server
