#include <gtest/gtest.h>

#include <algorithm>

#include "raykiln/lint/lint.hpp"

namespace raykiln::render {
namespace {

constexpr const char* kMaterials =
    "newmtl glass\nd 0\nTf 1 1 1\nKs 1 1 1\nNs 1000\nNi 1.5\nillum 7\n"
    "newmtl lamp\nKe 1 1 1\n"
    "newmtl bright\nKd 0.9 0.9 0.9\nKs 0.9 0.9 0.9\n";
constexpr const char* kCorners =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 5 5 5\nv 6 5 5\nv 5 6 5\n";
constexpr const char* kPyramid = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

std::vector<LintFinding> findings_of(const std::string& faces, const std::string& corners = kCorners) {
  MemoryFiles files;
  files.add("a.mtl", kMaterials);
  files.add("a.obj", corners + faces);
  const ImportResult result = import_scene(files);
  if (const auto* error = std::get_if<ImportError>(&result)) return {lint(*error)};
  return lint(std::get<ImportedScene>(result));
}

const LintFinding* find(const std::vector<LintFinding>& findings, const std::string& code) {
  const auto at = std::find_if(findings.begin(), findings.end(),
                               [&](const LintFinding& f) { return f.code == code; });
  return at == findings.end() ? nullptr : &*at;
}

bool has_errors(const std::vector<LintFinding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const LintFinding& f) { return f.level == LintLevel::kError; });
}

TEST(Lint, AClosedBodyOfGlassIsFine) {
  EXPECT_FALSE(has_errors(findings_of(std::string("usemtl glass\n") + kPyramid)));
}

TEST(Lint, CornersAreJoinedByPosition) {
  // The same pyramid, its last face with corners of its own.
  EXPECT_FALSE(has_errors(findings_of("usemtl glass\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 8 9 10\n",
                                      std::string(kCorners) + "v 1 0 0\nv 0 1 0\nv -0 0 1\n")));
}

TEST(Lint, OpenGlass) {
  const auto findings = findings_of("usemtl glass\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  ASSERT_NE(find(findings, "open_glass"), nullptr);
  EXPECT_EQ(find(findings, "open_glass")->count, 3U);
  EXPECT_EQ(find(findings, "open_glass")->level, LintLevel::kError);
  EXPECT_EQ(find(findings, "inside_out_glass"), nullptr) << "has no inside to be out";
}

TEST(Lint, InsideOutAndTwistedGlass) {
  const auto turned = findings_of("usemtl glass\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  ASSERT_NE(find(turned, "inside_out_glass"), nullptr);
  const auto twisted = findings_of("usemtl glass\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 4 3\n");
  ASSERT_NE(find(twisted, "twisted_glass"), nullptr);
  EXPECT_EQ(find(twisted, "twisted_glass")->count, 3U);
}

TEST(Lint, CrowdedGlass) {
  const auto findings = findings_of(std::string("usemtl glass\n") + kPyramid + "f 1 2 5\n");
  ASSERT_NE(find(findings, "crowded_glass"), nullptr);
  EXPECT_EQ(find(findings, "crowded_glass")->count, 1U);
}

TEST(Lint, AlbedoAboveOneAndMissingFiles) {
  EXPECT_TRUE(has_errors(findings_of("usemtl bright\nf 1 2 3\n")));
  const auto missing = findings_of("mtllib gone.mtl\nf 1 2 3\n");
  ASSERT_NE(find(missing, "missing_material_file"), nullptr);
  EXPECT_EQ(missing.front().level, LintLevel::kError) << "errors come first";
}

TEST(Lint, SliversAndCoarseEdges) {
  const auto sliver = findings_of("f 8 9 10\nf 1 2 3\n", std::string(kCorners) + "v 0 0 0\nv 1 0 0\nv 0.5 5e-5 0\n");
  ASSERT_NE(find(sliver, "sliver_triangles"), nullptr);
  EXPECT_EQ(find(sliver, "sliver_triangles")->count, 1U);
  EXPECT_EQ(find(findings_of("f 1 2 3\n"), "sliver_triangles"), nullptr);
  const auto coarse = findings_of("f 8 9 10\nf 1 2 3\n", std::string(kCorners) + "v 4000 0 0\nv 4000.001 0 0\nv 4000 0.001 0\n");
  ASSERT_NE(find(coarse, "coarse_edges"), nullptr);
  EXPECT_EQ(find(findings_of("f 1 2 3\n"), "coarse_edges"), nullptr);
}

TEST(Lint, EmittersWithoutAreaAndDegenerateTriangles) {
  const auto findings = findings_of("f 1 2 3\nusemtl lamp\nf 1 1 2\n");
  ASSERT_NE(find(findings, "emitter_without_area"), nullptr);
  EXPECT_NE(find(findings, "zero_area_triangles"), nullptr);
  EXPECT_EQ(find(findings_of("usemtl lamp\nf 1 2 3\n"), "emitter_without_area"), nullptr);
}

TEST(Lint, WhatAlphaLeavesNothingOf) {
  MemoryFiles files;
  files.add("a.obj", std::string(kCorners) + "f 1 2 3\n");
  ImportResult result = import_scene(files);
  auto& imported = std::get<ImportedScene>(result);
  EXPECT_EQ(find(lint(imported), "invisible_surface"), nullptr);
  imported.scene.materials[imported.scene.mesh.material_ids[0]].coverage = 0.0F;
  ASSERT_NE(find(lint(imported), "invisible_surface"), nullptr);
}

TEST(Lint, RefusedScenes) {
  const auto findings = findings_of("f 1 2 99\n");
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].code, "index_out_of_range");
  EXPECT_EQ(findings[0].level, LintLevel::kError);
  EXPECT_NE(findings[0].where.find("line"), std::string::npos);
}

}  // namespace
}  // namespace raykiln::render
