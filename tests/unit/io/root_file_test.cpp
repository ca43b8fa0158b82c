// Which file of an upload is read.
#include <string>

#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

using Code = ImportErrorCode;

const std::string kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(RootFile, TheOnlyCandidateIsRead) {
  EXPECT_EQ(expect_scene({{"x/My.OBJ", kObj}, {"readme.txt", ""}}).report.root_file, "x/My.OBJ");
}

TEST(RootFile, NoCandidate) {
  EXPECT_EQ(expect_error({}).code, Code::kNoSceneFile);
  EXPECT_EQ(expect_error({{"a.txt", ""}, {"obj", ""}, {"a.obj/b", ""}}).code, Code::kNoSceneFile);
}

TEST(RootFile, SeveralCandidatesAreNamed) {
  const ImportError error = expect_error({{"a.obj", kObj}, {"b.glb", ""}});
  EXPECT_EQ(error.code, Code::kAmbiguousScene);
  EXPECT_NE(error.message.find("'a.obj', 'b.glb'"), std::string::npos) << error.message;
  EXPECT_NE(error.remedy.find("raykiln.json"), std::string::npos);
}

TEST(RootFile, TheSidecarDecides) {
  const Texts files{{"a.obj", kObj}, {"b.obj", ""}, {"raykiln.json", R"({"scene": "a.obj"})"}};
  EXPECT_EQ(expect_scene(files).report.root_file, "a.obj");
}

TEST(RootFile, TheSidecarMayNotInvent) {
  for (const char* wanted : {"c.obj", "../a.obj", "/a.obj", ""}) {
    const std::string sidecar = std::string("{\"scene\": \"") + wanted + "\"}";
    const ImportError error = expect_error({{"a.obj", kObj}, {"raykiln.json", sidecar}});
    EXPECT_EQ(error.code, Code::kFileMissing) << wanted;
    EXPECT_EQ(error.where, "/scene");
  }
}

TEST(RootFile, TheSidecarMayNotNameAnotherFormat) {
  const ImportError error = expect_error(
      {{"a.obj", kObj}, {"a.txt", "x"}, {"raykiln.json", R"({"scene": "a.txt"})"}});
  EXPECT_EQ(error.code, Code::kNoSceneFile);
}

TEST(RootFile, OptionsWin) {
  ImportOptions options;
  options.root_file = "b.obj";
  EXPECT_EQ(expect_scene({{"a.obj", ""}, {"b.obj", kObj}}, options).report.root_file, "b.obj");
  options.root_file = "c.obj";
  EXPECT_EQ(expect_error({{"a.obj", kObj}}, options).code, Code::kFileMissing);
}

}  // namespace
}  // namespace raykiln::render::test
