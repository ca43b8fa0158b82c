// What the OBJ and MTL readers refuse, and where they say it is.
#include <string>

#include "support/io/import_text.hpp"

namespace raykiln::render::test {
namespace {

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";  // lines 1 to 3

struct Row {
  const char* name;
  std::string obj;
  ImportErrorCode code;
  const char* where;
};

class ObjRefuses : public testing::TestWithParam<Row> {};

TEST_P(ObjRefuses, WithItsPlace) {
  const Row& row = GetParam();
  const ImportError error = expect_error({{"dir/a.obj", row.obj}});
  EXPECT_EQ(name(error.code), name(row.code)) << error.message;
  EXPECT_EQ(error.file, "dir/a.obj");
  EXPECT_EQ(error.where, row.where);
  EXPECT_FALSE(error.message.empty());
}

using Code = ImportErrorCode;

INSTANTIATE_TEST_SUITE_P(
    All, ObjRefuses,
    testing::Values(
        Row{"index_too_large", kVertices + "f 1 2 4\n", Code::kIndexOutOfRange, "line 4"},
        Row{"index_zero", kVertices + "f 0 1 2\n", Code::kIndexOutOfRange, "line 4"},
        Row{"index_too_negative", kVertices + "f 1 2 -4\n", Code::kIndexOutOfRange, "line 4"},
        Row{"index_overflow", kVertices + "f 1 2 99999999999999999999\n", Code::kSyntax, "line 4"},
        Row{"index_2_to_32", kVertices + "f 1 2 4294967296\n", Code::kIndexOutOfRange, "line 4"},
        Row{"index_min", kVertices + "f 1 2 -9223372036854775808\n", Code::kIndexOutOfRange,
            "line 4"},
        Row{"index_max", kVertices + "f 1 2 9223372036854775807\n", Code::kIndexOutOfRange,
            "line 4"},
        Row{"normal_out_of_range", kVertices + "f 1//1 2//1 3//1\n", Code::kIndexOutOfRange,
            "line 4"},
        Row{"nan", "v 0 0 0\nv nan 0 0\n", Code::kNotFinite, "line 2"},
        Row{"inf", "v 0 0 -inf\n", Code::kNotFinite, "line 1"},
        Row{"infinity", "v 0 +infinity 0\n", Code::kNotFinite, "line 1"},
        Row{"overflow", "v 1e999 0 0\n", Code::kNotFinite, "line 1"},
        Row{"nan_normal", kVertices + "vn 0 0 nan\n", Code::kNotFinite, "line 4"},
        Row{"huge", "v 1e308 0 0\n", Code::kCoordinateTooLarge, "line 1"},
        Row{"limit", "v 0 -1.1e15 0\n", Code::kCoordinateTooLarge, "line 1"},
        Row{"two_numbers", "v 0 0\n", Code::kSyntax, "line 1"},
        Row{"comment_for_number", "v 0 0 #1\n", Code::kSyntax, "line 1"},
        Row{"word_for_number", "v 0 zero 0\n", Code::kSyntax, "line 1"},
        Row{"number_with_tail", "v 0 1.0x 0\n", Code::kSyntax, "line 1"},
        Row{"hex", "v 0x10 0 0\n", Code::kSyntax, "line 1"},
        Row{"two_signs", "v +-1 0 0\n", Code::kSyntax, "line 1"},
        Row{"two_corners", kVertices + "f 1 2\n", Code::kSyntax, "line 4"},
        Row{"no_corner", kVertices + "f\n", Code::kSyntax, "line 4"},
        Row{"corner_text", kVertices + "f 1 2 x\n", Code::kSyntax, "line 4"},
        Row{"corner_slash", kVertices + "f 1 2 3/x\n", Code::kSyntax, "line 4"},
        Row{"corner_tail", kVertices + "f 1 2 3/1/1/1\n", Code::kSyntax, "line 4"},
        Row{"binary", std::string("\x01\x02\x03\x00zzz\n", 8), Code::kSyntax, "line 1"},
        Row{"utf16", "\xFE\xFF\x01v", Code::kUnsupportedEncoding, "line 1"},
        Row{"after_continuation", "v 0 0 \\\n0\nv 1 0\n", Code::kSyntax, "line 3"},
        Row{"late_index", "f 1 2 9\n" + kVertices, Code::kIndexOutOfRange, "line 1"},
        Row{"no_triangle", kVertices, Code::kEmptyScene, ""},
        Row{"empty", "", Code::kEmptyScene, ""},
        Row{"only_flat", kVertices + "f 1 1 2\nf 1 2 2\n", Code::kEmptyScene, ""}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(ObjLimits, AreNamedConstantsThatHold) {
  ImportOptions options;
  options.limits.max_triangles = 2;
  options.limits.max_vertices = 4;
  options.limits.max_line_bytes = 100;
  options.limits.max_polygon_corners = 5;
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(expect_scene({{"a.obj", square + "f 1 2 3 4\n"}}, options).scene.mesh.triangles.size(),
            2U);
  EXPECT_EQ(expect_error({{"a.obj", square + "f 1 2 3 4\nf 1 2 3\n"}}, options).code,
            Code::kLimitExceeded);
  EXPECT_EQ(expect_error({{"a.obj", square + "v 0 0 0\n"}}, options).where, "line 5");
  EXPECT_EQ(expect_error({{"a.obj", square + "f 1 2 3 4 1 2\n"}}, options).code,
            Code::kLimitExceeded);
  const ImportError joined =
      expect_error({{"a.obj", "v 0 0\\\n" + std::string(101, ' ') + "\\\n0\n"}}, options);
  EXPECT_EQ(joined.code, Code::kLineTooLong);
}

TEST(ObjLimits, ALineThatNeverEndsIsRefusedBeforeItIsRead) {
  ImportOptions options;
  options.limits.max_line_bytes = 1 << 16;
  const ImportError error =
      expect_error({{"a.obj", "v 0 0 0\n" + std::string(std::size_t{8} << 20, 'x')}}, options);
  EXPECT_EQ(error.code, Code::kLineTooLong);
  EXPECT_EQ(error.where, "line 2");
}

TEST(ObjLimits, ConcavePolygonsHaveABoundOfTheirOwn) {
  std::string text;
  std::string face = "f";
  for (int i = 0; i < 2000; ++i) {  // a star: every second corner is a notch
    const double angle = i * 3.14159265358979 / 1000.0;
    const double r = i % 2 == 0 ? 2.0 : 1.0;
    text += "v " + std::to_string(r * std::cos(angle)) + " " + std::to_string(r * std::sin(angle)) +
            " 0\n";
    face += " " + std::to_string(i + 1);
  }
  const ImportError error = expect_error({{"a.obj", text + face + "\n"}});
  EXPECT_EQ(error.code, Code::kLimitExceeded);
  EXPECT_EQ(error.where, "line 2001");
}

TEST(ObjStop, AStopRequestEndsTheImport) {
  std::stop_source source;
  source.request_stop();
  ImportOptions options;
  options.stop = source.get_token();
  EXPECT_EQ(expect_error({{"a.obj", kVertices + "f 1 2 3\n"}}, options).code, Code::kStopped);
}

TEST(ErrorText, IsUtf8WithoutControlCharacters) {
  const ImportError error = expect_error({{"a.obj", "v \xFF\xFE\x01\xC3\x28 0 0\n"}});
  EXPECT_EQ(error.code, Code::kSyntax);
  for (const char c : error.message) EXPECT_TRUE(c >= 0x20 && c < 0x7F) << error.message;
}

}  // namespace
}  // namespace raykiln::render::test
