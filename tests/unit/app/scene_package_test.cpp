#include "raykiln/app/scene_package.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

namespace fs = std::filesystem;

class ScenePackageTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "raykiln_scene_package";
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "textures");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  [[nodiscard]] std::vector<std::string> names(const std::string& scene) const {
    const auto package = find_scene_files(folder_ / scene);
    std::vector<std::string> list;
    if (!package) return {package.error().code};
    for (const auto& file : package->files) list.push_back(file.name);
    return list;
  }

  fs::path folder_;
};

using Names = std::vector<std::string>;

TEST_F(ScenePackageTest, FindsWhatAnObjNames) {
  write("a.obj", "mtllib b.mtl with space.mtl\r\nv 0 0 0\nmtllib ../secret.mtl\nmtllib absent.mtl\n");
  write("b.mtl", "");
  write("other.mtl", "");
  write("raykiln.json", "{}");
  EXPECT_EQ(names("a.obj"), (Names{"a.obj", "b.mtl", "raykiln.json"}));
  write("with space.mtl", "");
  write("c.obj", "mtllib with space.mtl\n");
  EXPECT_EQ(names("c.obj"), (Names{"c.obj", "raykiln.json", "with space.mtl"}));
}

TEST_F(ScenePackageTest, TakesTexturesAndTheEnvironmentAlong) {
  write("a.obj", "mtllib textures/m.mtl\n");
  write("textures/m.mtl", "newmtl a\n  map_Kd -s 2 2 my wood.png\r\nmap_Ke ..\\glow.png\n# map_Kd n.png\n");
  write("raykiln.json", R"({"environment": {"file": "sky.exr"}})");
  for (const char* name : {"textures/my wood.png", "textures/n.png", "glow.png", "sky.exr"}) write(name, "");
  EXPECT_EQ(names("a.obj"), (Names{"a.obj", "glow.png", "raykiln.json", "sky.exr", "textures/m.mtl", "textures/my wood.png"}));
}

TEST_F(ScenePackageTest, FindsWhatAGltfNames) {
  write("a.gltf", R"({"buffers":[{"uri" : "a%20b.bin"},{"uri":"data:x"},{"uri":"../x"}],"images":[{"uri":"textures/t.png"}]})");
  write("a b.bin", "");
  write("textures/t.png", "");
  EXPECT_EQ(names("a.gltf"), (Names{"a b.bin", "a.gltf", "textures/t.png"}));
}

TEST_F(ScenePackageTest, TakesFoldersAndSingleFiles) {
  write("b.obj", "");
  write("textures/t.png", "");
  fs::create_symlink("/etc/passwd", folder_ / "link");
  EXPECT_EQ(names(""), (Names{"b.obj", "textures/t.png"}));
  write("A.GLB", "");
  EXPECT_EQ(names("A.GLB"), Names{"A.GLB"});
  EXPECT_EQ(names("absent.obj"), Names{"file_missing"});
  EXPECT_EQ(names("textures/t.png"), Names{"scene_unsupported"});
}

TEST_F(ScenePackageTest, ComputesTheIdOfTheContract) {
  write("b.obj", "bb");
  write("a.mtl", "a");
  const auto package = find_scene_files(folder_);
  ASSERT_TRUE(package);
  const std::string list = std::string("a.mtl\0", 6) + std::string("1\0", 2) + sha256_hex("a") + "\n" +
                           std::string("b.obj\0", 6) + std::string("2\0", 2) + sha256_hex("bb") + "\n";
  EXPECT_EQ(*scene_id(*package), sha256_hex(list));
  write("s.zip", "zip");
  EXPECT_EQ(*scene_id(*find_scene_files(folder_ / "s.zip")), sha256_hex("zip"));
}

}  // namespace
}  // namespace raykiln::server
