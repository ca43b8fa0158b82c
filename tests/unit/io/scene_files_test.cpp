// Folders and names: nothing leads out.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "raykiln/io/scene_files.hpp"

namespace raykiln::render {
namespace {

namespace fs = std::filesystem;

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() /
            ("raykiln_files_" + std::to_string(::getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(root_ / "upload/sub");
    write("secret.obj", "secret");
    write("upload/a.obj", "abc");
    write("upload/sub/b.mtl", "");
  }
  void TearDown() override { fs::remove_all(root_); }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(root_ / name) << text;
  }
  fs::path root_;
};

TEST_F(Folder, ListsAndReadsRegularFiles) {
  const DirectoryFiles files(root_ / "upload");
  EXPECT_EQ(files.names(), (std::vector<std::string>{"a.obj", "sub/b.mtl"}));
  const auto file = files.open("a.obj");
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->size(), 3U);
  char bytes[8] = {};
  EXPECT_EQ(file->read(bytes), 3U);
  EXPECT_EQ(std::string(bytes, 3), "abc");
  EXPECT_EQ(file->read(bytes), 0U);
}

TEST_F(Folder, NoNameLeadsOut) {
  const DirectoryFiles files(root_ / "upload");
  for (const std::string name : {"../secret.obj", "sub/../../secret.obj", "/etc/passwd", "", ".",
                                 "..", "sub//b.mtl", "sub/", "sub\\b.mtl", "./a.obj"}) {
    EXPECT_EQ(files.open(name), nullptr) << name;
  }
  EXPECT_EQ(files.open((root_ / "secret.obj").string()), nullptr);
}

TEST_F(Folder, NoLinkIsFollowed) {
  fs::create_symlink(root_ / "secret.obj", root_ / "upload/link.obj");
  fs::create_directory_symlink(root_, root_ / "upload/dir");
  const DirectoryFiles files(root_ / "upload");
  EXPECT_EQ(files.names().size(), 2U);
  EXPECT_EQ(files.open("link.obj"), nullptr);
  EXPECT_EQ(files.open("dir/secret.obj"), nullptr);
}

TEST_F(Folder, NeitherFoldersNorPipesAreFiles) {
  ASSERT_EQ(::mkfifo((root_ / "upload/pipe.obj").c_str(), 0600), 0);
  const DirectoryFiles files(root_ / "upload");
  EXPECT_EQ(files.names().size(), 2U);
  EXPECT_EQ(files.open("sub"), nullptr);
  EXPECT_EQ(files.open("pipe.obj"), nullptr);
}

TEST_F(Folder, AMissingFolderIsEmpty) {
  const DirectoryFiles files(root_ / "nowhere");
  EXPECT_TRUE(files.names().empty());
  EXPECT_EQ(files.open("a.obj"), nullptr);
}

TEST(SafeName, HasABound) {
  EXPECT_TRUE(is_safe_name(std::string(1024, 'a')));
  EXPECT_FALSE(is_safe_name(std::string(1025, 'a')));
  EXPECT_FALSE(is_safe_name(std::string("a\0b", 3)));
  EXPECT_TRUE(is_safe_name("..a/b..c"));
}

}  // namespace
}  // namespace raykiln::render
