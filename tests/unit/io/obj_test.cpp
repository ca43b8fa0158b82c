// What the OBJ reader accepts.
#include <string>

#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

struct Row {
  const char* name;
  std::string obj;
  std::size_t triangles;
  double area;
};

class ObjAccepts : public testing::TestWithParam<Row> {};

TEST_P(ObjAccepts, Geometry) {
  const Row& row = GetParam();
  const ImportedScene imported = expect_scene({{"a.obj", row.obj}});
  ASSERT_EQ(imported.scene.mesh.triangles.size(), row.triangles);
  EXPECT_NEAR(total_area(imported.scene), row.area, 1e-6);
  for (std::size_t i = 0; i < row.triangles; ++i) {
    EXPECT_NEAR(normal_of(imported.scene, i).z, 1.0, 1e-6) << "winding of triangle " << i;
  }
  expect_sound(imported);
}

INSTANTIATE_TEST_SUITE_P(
    All, ObjAccepts,
    testing::Values(
        Row{"plain", kSquare + "f 1 2 3\n", 1, 0.5}, Row{"quad", kSquare + "f 1 2 3 4\n", 2, 1.0},
        Row{"negative", kSquare + "f -4 -3 -2 -1\n", 2, 1.0},
        Row{"no_last_newline", kSquare + "f 1 2 3", 1, 0.5},
        Row{"crlf", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", 1, 0.5},
        Row{"tabs", "v\t0\t0 0\nv  1 0   0 \nv 0 1 0\nf  1\t2 3 \n", 1, 0.5},
        Row{"continued", "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\r\n2 \\\n 3\n", 1, 0.5},
        Row{"comment_with_backslash", "# C:\\dir\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 1, 0.5},
        Row{"comment_behind", "v 0 0 0 # a\nv 1 0 0\nv 0 1 0\nf 1 2 3 # b\n", 1, 0.5},
        Row{"texture_and_normal", kSquare + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n", 1, 0.5},
        Row{"normal_only", kSquare + "vn 0 0 1\nf 1//1 2//1 3//1\n", 1, 0.5},
        Row{"texture_only", kSquare + "f 1/1 2/2 3/3\n", 1, 0.5},
        Row{"faces_before_vertices", "f 1 2 3 4\n" + kSquare, 2, 1.0},
        Row{"numbers", "v +0 -0.0 0e5\nv 1.e0 .0 0\nv 0 1E+0 1e-400\nf 1 2 3\n", 1, 0.5},
        Row{"weight_and_colour", "v 0 0 0 1\nv 1 0 0 1 0.5 0 0\nv 0 1 0\nf 1 2 3\n", 1, 0.5},
        Row{"utf8_mark", "\xEF\xBB\xBF" + kSquare + "f 1 2 3\n", 1, 0.5},
        Row{"concave_arrow", "v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 1 2 3 4\n", 2, 1.0},
        Row{"concave_from_the_notch", "v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 3 4 1 2\n", 2, 1.0},
        Row{"comb",
            "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 3 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\n"
            "v 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8 9 10 11 12\n",
            10, 11.0}),
    [](const auto& row) { return std::string(row.param.name); });

std::vector<std::uint32_t> objects_of(const Scene& scene) {
  std::vector<std::uint32_t> objects;
  for (std::uint32_t id = 0; id < scene.mesh.triangles.size(); ++id) objects.push_back(object_of(scene.mesh, id));
  return objects;
}

TEST(Obj, ObjectsAreTheirStatementsAndGroupsElse) {
  using Ids = std::vector<std::uint32_t>;
  using Names = std::vector<std::string>;
  const std::string flat = "v 5 0 0\nf 1 2 5\n", face = "f 1 2 3\n";  // 1, 2 and 5 lie in a line
  const auto by_object = expect_scene({{"a.obj", kSquare + "o none\no a\ng x\n" + face + "g y\n" + face + "o b\n" + flat +
                                                     face + "o a\n" + face + "o last\n" + flat}});
  EXPECT_EQ(by_object.scene.object_names, (Names{"a", "b", "last"}));
  EXPECT_EQ(objects_of(by_object.scene), (Ids{0, 0, 1, 0}));
  const auto by_group = expect_scene({{"a.obj", kSquare + face + "g x\n" + face + "g y\nf 1 2 9\nf 2 3 4\nv 0 0 1\n" +
                                                    "v 0 0 2\nv 0 0 3\nv 0 0 4\nv 0 0 5\ng z\n" + face}});
  EXPECT_EQ(by_group.scene.object_names, (Names{"", "x", "y", "z"}));
  // The face that had to wait for its vertex comes last, and is of its object.
  EXPECT_EQ(objects_of(by_group.scene), (Ids{0, 1, 2, 3, 2}));
}

TEST(Obj, LinesAndPointsAreListedAndIgnored) {
  const auto imported = expect_scene({{"a.obj", kSquare + "l 1 2\np 1\np 2\nf 1 2 3\n"}});
  EXPECT_EQ(count_of(imported, ImportWarningCode::kIgnoredElement), 3U);
}

TEST(Obj, UnknownStatementsAreOneWarningAKind) {
  const auto imported = expect_scene({{"a.obj", kSquare + "foo 1\nfoo 2\nbar\nf 1 2 3\n"}});
  EXPECT_EQ(count_of(imported, ImportWarningCode::kUnknownStatement), 3U);
  const auto& first = imported.report.warnings[0];
  EXPECT_EQ(first.count, 2U);
  EXPECT_EQ(first.file, "a.obj");
  EXPECT_EQ(first.where, "line 5");
}

TEST(Obj, WarningsAreBounded) {
  std::string text = kSquare;
  for (int i = 0; i < 1000; ++i) text += "word" + std::to_string(i) + " 1\n";
  ImportOptions options;
  options.limits.max_warnings = 8;
  const auto imported = expect_scene({{"a.obj", text + "f 1 2 3\n"}}, options);
  EXPECT_EQ(imported.report.warnings.size(), 9U);
  std::uint64_t total = 0;
  for (const ImportWarning& warning : imported.report.warnings) total += warning.count;
  EXPECT_EQ(imported.report.warnings.back().code, ImportWarningCode::kMoreWarnings);
  EXPECT_GE(total, 1000U) << "nothing is lost from the count";
}

TEST(Obj, NormalsAreBroughtToUnitLength) {
  const auto imported =
      expect_scene({{"a.obj", kSquare + "vn 0 0 5\nvn 0 0 1e300\nvn 0 0 0\nf 1//1 2//2 3//3\n"}});
  const TriangleMesh& mesh = imported.scene.mesh;
  ASSERT_EQ(mesh.corner_normals.size(), 1U);
  EXPECT_EQ(mesh.normals[mesh.corner_normals[0][0]], Vec3f(0.0F, 0.0F, 1.0F));
  EXPECT_EQ(mesh.normals[mesh.corner_normals[0][1]], Vec3f(0.0F, 0.0F, 1.0F));
  EXPECT_EQ(mesh.corner_normals[0][2], kNoNormal);
  EXPECT_EQ(count_of(imported, ImportWarningCode::kInvalidNormal), 1U);
}

TEST(Obj, FacesWithAndWithoutNormalsMix) {
  const auto imported = expect_scene({{"a.obj", kSquare + "vn 0 0 1\nf 1 2 3\nf 1//1 3//1 4//1\n"}});
  const TriangleMesh& mesh = imported.scene.mesh;
  ASSERT_EQ(mesh.corner_normals.size(), 2U);
  EXPECT_EQ(mesh.corner_normals[0][0], kNoNormal);
  EXPECT_EQ(mesh.corner_normals[1][0], 0U);
}

TEST(Obj, CrossingPolygonsAreCutWithAWarning) {
  const auto imported = expect_scene(
      {{"a.obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n"}});
  EXPECT_EQ(imported.report.source_triangles, 2U);
  EXPECT_EQ(count_of(imported, ImportWarningCode::kBadPolygon), 1U);
}

TEST(Obj, ReadsAcrossBlockBordersLikeInOnePiece) {
  std::string text;
  for (int i = 0; i < 60'000; ++i) {
    text += "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i + 1) + " 0 0\nv " +
            std::to_string(i) + " 1 0\nf -3 -2 -1\n";
  }
  ASSERT_GT(text.size(), std::size_t{2} << 20);
  const auto imported = expect_scene({{"a.obj", text}});
  ASSERT_EQ(imported.scene.mesh.triangles.size(), 60'000U);
  EXPECT_NEAR(total_area(imported.scene), 30'000.0, 1e-6);
}

}  // namespace
}  // namespace raykiln::render::test
