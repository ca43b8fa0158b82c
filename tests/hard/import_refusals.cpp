// K03 (report), K07, V08: what an import refuses, drops and warns about, and what is left unharmed.
#include <cstdio>
#include <cstring>
#include <sstream>

#include "hard/support/hard_meshes.hpp"
#include "hard/support/pictures.hpp"
#include "hard/support/report.hpp"
#include "raykiln/io/import.hpp"

namespace raykiln::hard {
namespace {

using namespace render;

// OBJ with the positions moved in double.
std::string obj_text(const TestMesh& mesh, const Vec3d& shift = Vec3d(0.0)) {
  std::ostringstream out;
  out.precision(17);
  for (const Vec3f& p : mesh.positions) {
    const Vec3d q = Vec3d(p) + shift;
    out << "v " << q.x << ' ' << q.y << ' ' << q.z << '\n';
  }
  for (const auto& t : mesh.triangles) {
    out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
  return out.str();
}

std::string point(const Vec3d& p) {
  char text[120];
  std::snprintf(text, sizeof text, "[%.17g,%.17g,%.17g]", p.x, p.y, p.z);
  return text;
}

std::string sidecar_text(const Vec3d& shift) {
  return R"({"camera":{"eye":)" + point(Vec3d(0.5, 0.5, 3.0) + shift) + R"(,"look_at":)" +
         point(Vec3d(0.5, 0.5, 0.0) + shift) + R"(,"up":[0,1,0],"fov_deg":25},)" +
         R"("point_lights":[{"position":)" + point(Vec3d(0.2, 0.3, 1.5) + shift) +
         R"(,"intensity":[5,5,5]}]})";
}

ImportResult import_files(std::map<std::string, std::string> files) {
  return import_scene(MemoryFiles(std::move(files)));
}

ImportedScene imported(std::map<std::string, std::string> files) {
  auto result = import_files(std::move(files));
  if (const auto* error = std::get_if<ImportError>(&result)) {
    ADD_FAILURE() << name(error->code) << ": " << error->message;
    return {};
  }
  return std::get<ImportedScene>(std::move(result));
}

// ---- K03: dropped and counted, with no trace in the picture ----

// The mesh with `extra` degenerate triangles of three kinds scattered through its list.
TestMesh with_degenerate(const TestMesh& mesh, std::uint32_t extra, TestRandom& random) {
  TestMesh result = mesh;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < 7; ++i) {  // integers on a line
    result.positions.push_back(Vec3f(1.0F, 2.0F, 3.0F) * static_cast<float>(i) - Vec3f(2.0F));
  }
  for (std::uint32_t i = 0; i < extra; ++i) {
    const std::uint32_t a = random.below(base);
    const std::uint32_t b = random.below(base);
    std::array<std::uint32_t, 3> t{a, a, a};
    if (i % 3 == 1) t = {a, b, a};
    if (i % 3 == 2) t = {base + random.below(2), base + 2 + random.below(2), base + 4 + random.below(3)};
    const auto at = random.below(static_cast<std::uint32_t>(result.triangles.size()));
    result.triangles.insert(result.triangles.begin() + at, t);
  }
  return result;
}

TEST(K03_DegenerateTriangles, DroppedAndCounted) {
  Row row("K03", "10k terrain and 10 % extra: three equal, two equal, collinear integers; 3 members",
          "picture bit-identical to the mesh without them; count exact", "physical");
  TestRandom random(310);
  std::uint64_t wrong_counts = 0, wrong_pictures = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const TestMesh mesh = test::terrain(71, seed);
    const auto extra = static_cast<std::uint32_t>(mesh.triangles.size() / 10);
    const auto clean = imported({{"a.obj", obj_text(mesh)}, {"raykiln.json", sidecar_text(Vec3d(0.0))}});
    const auto dirty = imported({{"a.obj", obj_text(with_degenerate(mesh, extra, random))},
                                 {"raykiln.json", sidecar_text(Vec3d(0.0))}});
    wrong_counts += dirty.report.zero_area_triangles == extra ? 0U : 1U;
    RenderSettings settings;
    settings.width = settings.height = 64;
    settings.max_depth = 3;
    const auto a = picture(clean.scene, settings, 4);
    const auto b = picture(dirty.scene, settings, 4);
    wrong_pictures += a.hash == b.hash ? 0U : 1U;
    EXPECT_GT(a.mean, 0.0);
  }
  row.never("wrong counts", wrong_counts, 3);
  row.never("pictures that differ", wrong_pictures, 3);
  EXPECT_EQ(wrong_counts, 0U);
  EXPECT_EQ(wrong_pictures, 0U);
}

// ---- K07: NaN, Inf and absurd numbers ----

struct Refusals {
  std::uint64_t tried = 0, accepted = 0, unnamed = 0;
  double slowest = 0.0;
};

void expect_refused(std::map<std::string, std::string> files, Refusals& refusals) {
  const double start = cpu_seconds();  // what others do meanwhile is not the reader's time
  const auto result = import_files(std::move(files));
  refusals.slowest = std::max(refusals.slowest, cpu_seconds() - start);
  ++refusals.tried;
  const auto* error = std::get_if<ImportError>(&result);
  if (error == nullptr) {
    ++refusals.accepted;
  } else if (error->message.empty() || error->where.empty()) {
    ++refusals.unnamed;
  }
}

TEST(K07_AbsurdNumbers, ObjAndSidecar) {
  Row row("K07", "NaN, +-Inf, 3.4e38, 1e400 as one coordinate of a 1k mesh, of a light, of a camera",
          "refused within 1 s, named with its line; the next scene is read as before");
  TestRandom random(701);
  const TestMesh mesh = test::terrain(22);
  const std::string text = obj_text(mesh);
  const auto before = imported({{"a.obj", text}});
  Refusals refusals;
  for (const char* word : {"nan", "NaN", "-nan", "inf", "-inf", "Infinity", "3.4e38", "-3.4e38", "1e400"}) {
    for (int member = 0; member < 10; ++member) {
      std::istringstream lines(text);
      std::string spoilt;
      const std::string bad_line = std::string("v 0.5 ").append(word).append(" 0.25");
      const std::uint32_t target = random.below(23 * 23);
      std::uint32_t at = 0;
      for (std::string line; std::getline(lines, line); ++at) {
        spoilt += std::string(at == target ? bad_line : line).append("\n");
      }
      expect_refused({{"a.obj", spoilt}}, refusals);
    }
    const std::string bad = std::string("[0,").append(word).append(",0]");
    expect_refused({{"a.obj", text},
                    {"raykiln.json", R"({"point_lights":[{"position":)" + bad + R"(,"intensity":[1,1,1]}]})"}},
                   refusals);
    expect_refused({{"a.obj", text},
                    {"raykiln.json", R"({"camera":{"eye":)" + bad + R"(,"look_at":[0,0,1]}})"}},
                   refusals);
  }
  const auto after = imported({{"a.obj", text}});
  row.never("accepted", refusals.accepted, refusals.tried);
  row.never("without a place", refusals.unnamed, refusals.tried);
  row.measured("slowest s", refusals.slowest);
  EXPECT_EQ(refusals.accepted, 0U);
  EXPECT_EQ(refusals.unnamed, 0U);
  EXPECT_LE(refusals.slowest, 1.0);
  EXPECT_TRUE(before.scene.mesh.positions == after.scene.mesh.positions);
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63U];
    }
  }
  return out;
}

// A glTF of separate triangles with these float bits as positions, and as normals if there are any.
std::string gltf_text(const std::vector<float>& numbers, const std::vector<float>& normals = {}) {
  std::string bytes((numbers.size() + normals.size()) * 4, '\0');
  std::memcpy(bytes.data(), numbers.data(), numbers.size() * 4);
  if (!normals.empty()) std::memcpy(bytes.data() + numbers.size() * 4, normals.data(), normals.size() * 4);
  const auto accessor = [](const std::vector<float>& values, std::size_t offset) {
    return R"({"bufferView":0,"byteOffset":)" + std::to_string(offset) +
           R"(,"componentType":5126,"count":)" + std::to_string(values.size() / 3) +
           R"(,"type":"VEC3"})";
  };
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0)" +
         std::string(normals.empty() ? "" : R"(,"NORMAL":1)") + R"(}}]}],"accessors":[)" +
         accessor(numbers, 0) +
         (normals.empty() ? "" : std::string(",").append(accessor(normals, numbers.size() * 4))) +
         R"(],"bufferViews":[{"buffer":0,"byteLength":)" +
         std::to_string(bytes.size()) + R"(}],"buffers":[{"byteLength":)" +
         std::to_string(bytes.size()) + R"(,"uri":"data:application/octet-stream;base64,)" +
         base64(bytes) + R"("}]})";
}

TEST(K07_AbsurdNumbers, GltfRandomBits) {
  Row row("K07", "glTF: one NaN, Inf or 3.4e38 in a 1k mesh; whole meshes of random bit patterns",
          "refused with a place, or every number of the scene finite and a picture rendered");
  TestRandom random(702);
  Refusals refusals;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), 3.4e38F}) {
    for (int member = 0; member < 10; ++member) {
      std::vector<float> numbers(9000);
      for (float& x : numbers) x = random.uniform();
      numbers[random.below(9000)] = bad;
      expect_refused({{"a.gltf", gltf_text(numbers)}}, refusals);
    }
  }
  row.never("accepted", refusals.accepted, refusals.tried);
  row.never("without a place", refusals.unnamed, refusals.tried);
  EXPECT_EQ(refusals.accepted, 0U);
  EXPECT_EQ(refusals.unnamed, 0U);
  std::uint64_t not_finite = 0, taken = 0;
  for (int member = 0; member < 400; ++member) {
    std::vector<float> numbers(9);
    for (float& x : numbers) {
      const std::uint32_t bits = static_cast<std::uint32_t>(random.bits());
      std::memcpy(&x, &bits, sizeof x);
    }
    const auto result = import_files({{"a.gltf", gltf_text(numbers)}});
    const auto* scene = std::get_if<ImportedScene>(&result);
    if (scene == nullptr) continue;
    ++taken;
    for (const Vec3f& p : scene->scene.mesh.positions) {
      not_finite += std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) ? 0U : 1U;
    }
    RenderSettings settings;
    settings.width = settings.height = 4;
    EXPECT_EQ(picture(scene->scene, settings, 1).non_finite, 0U);
  }
  row.never("random bits: taken", taken, 400);
  row.measured("numbers not finite", not_finite);
  EXPECT_EQ(not_finite, 0U);
  EXPECT_GT(taken, 0U);
}

TEST(K07_AbsurdNumbers, Normals) {
  Row row("K07", "one NaN, Inf, 3.4e38, 1e-45 or zero vector among the 3000 normals of a 1k mesh (glTF), 300 members; "
          "NaN, Inf and 1e400 (OBJ)",
          "not finite: refused with its place; zero: replaced by the triangle's and counted; else made a unit vector");
  TestRandom random(703);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  std::uint64_t not_unit = 0, wrong_count = 0, members = 0;
  Refusals refusals;
  for (const float bad : {nan, inf, -inf, 3.4e38F, 1e-45F, 0.0F}) {
    for (int member = 0; member < 50; ++member) {
      std::vector<float> numbers(9000), normals(9000);
      for (float& x : numbers) x = random.uniform();
      for (float& x : normals) x = random.uniform(0.1F, 1.0F);
      const std::uint32_t target = random.below(9000), corner = target / 3 * 3;
      if (std::abs(bad) < 1.0F) normals[corner] = normals[corner + 1] = normals[corner + 2] = 0.0F;
      normals[target] = bad;
      if (!std::isfinite(bad)) {
        expect_refused({{"a.gltf", gltf_text(numbers, normals)}}, refusals);
        continue;
      }
      ++members;
      const auto scene = imported({{"a.gltf", gltf_text(numbers, normals)}});
      std::uint64_t counted = 0;
      for (const auto& w : scene.report.warnings) {
        if (w.code == ImportWarningCode::kInvalidNormal) counted += w.count;
      }
      wrong_count += counted == (bad == 0.0F ? 1U : 0U) ? 0U : 1U;
      for (const auto& corners : scene.scene.mesh.corner_normals) {
        for (const std::uint32_t id : corners) {
          if (id == kNoNormal) continue;
          const double size = length(Vec3d(scene.scene.mesh.normals[id]));
          not_unit += std::abs(size - 1.0) <= 1e-6 ? 0U : 1U;
        }
      }
    }
  }
  for (const char* word : {"nan", "inf", "-inf", "1e400"}) {
    expect_refused({{"a.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 ").append(word).append(" 1\nf 1//1 2//1 3//1\n")}},
                   refusals);
  }
  row.never("normals in use that are not unit", not_unit, members * 3000);
  row.never("wrong counts", wrong_count, members);
  row.never("not finite: accepted or without a place", refusals.accepted + refusals.unnamed, refusals.tried);
  EXPECT_EQ(not_unit, 0U);
  EXPECT_EQ(wrong_count, 0U);
  EXPECT_EQ(refusals.accepted + refusals.unnamed, 0U);
}

// ---- V08: millimetres at a thousand kilometres ----

// A square of 1 m with a relief of 1 mm.
TestMesh relief(std::uint64_t seed) {
  TestMesh mesh = test::terrain(24, seed);
  for (Vec3f& p : mesh.positions) p.z *= 1e-3F;
  return mesh;
}

TEST(V08_FarAway, DoubleInputKeepsItsDigits) {
  Row row("V08", "1 m with a relief of 1 mm, moved by up to (+-1e6, +-1e6, +-1e6) m in double; 6 members",
          "picture statistically equal to the one not moved", "physical");
  TestRandom random(801);
  double worst_share = 1.0, worst_z = 0.0;
  for (std::uint64_t member = 0; member < 6; ++member) {
    const TestMesh mesh = relief(member + 1);
    const Vec3d shift = member == 0 ? Vec3d(1e6, 1e6, 0.0) : 1e6 * Vec3d(random.in_box(-1.0F, 1.0F));
    const auto here = imported({{"a.obj", obj_text(mesh)}, {"raykiln.json", sidecar_text(Vec3d(0.0))}});
    const auto there = imported({{"a.obj", obj_text(mesh, shift)}, {"raykiln.json", sidecar_text(shift)}});
    RenderSettings settings;
    settings.width = settings.height = 48;
    settings.max_depth = 2;
    const auto a = picture(here.scene, settings, 64);
    settings.seed = 1;
    const auto b = picture(there.scene, settings, 64);
    const auto compared = compare_images(a.pixels, b.pixels);
    worst_share = std::min(worst_share, compared.accepted_share);
    worst_z = std::max(worst_z, std::abs(compared.mean_z));
  }
  row.measured("smallest share of pixels in the band", worst_share);
  row.measured("largest |z| of the mean", worst_z);
  EXPECT_GE(worst_share, 0.9975);
  EXPECT_LE(worst_z, 4.0);
}

TEST(V08_FarAway, SingleInputIsWarnedAbout) {
  Row row("V08", "the same in single precision (glTF) at 1e6 m: ulp 0.0625 m",
          "a warning with the ratio of the shortest edge to the ulp; no NaN", "physical");
  TestRandom random(802);
  const TestMesh mesh = relief(3);
  std::vector<float> numbers;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const Vec3f& p : mesh.corners(i)) {
      const Vec3f moved = p + Vec3f(1e6F, 1e6F, 0.0F);
      numbers.insert(numbers.end(), {moved.x, moved.y, moved.z});
    }
  }
  const auto scene = imported({{"a.gltf", gltf_text(numbers)}});
  std::uint64_t warned = 0;
  double ratio = 0.0;
  for (const ImportWarning& w : scene.report.warnings) {
    if (w.code != ImportWarningCode::kCoarseCoordinates) continue;
    ++warned;
    std::sscanf(w.message.c_str() + w.message.find("shortest edge is ") + 17, "%lf", &ratio);
  }
  RenderSettings settings;
  settings.width = settings.height = 16;
  const auto image = picture(scene.scene, settings, 4);
  row.measured("warnings", warned);
  row.measured("shortest edge in steps of the coordinates, as warned", ratio);
  row.measured("samples not finite", image.non_finite);
  row.measured("zero-area triangles dropped", scene.report.zero_area_triangles);
  EXPECT_EQ(warned, 1U);
  EXPECT_GT(ratio, 0.0);  // corners that fell into one place differ by their relief alone
  EXPECT_LT(ratio, 0.1);
  EXPECT_EQ(image.non_finite, 0U);
}

}  // namespace
}  // namespace raykiln::hard
