#include "raykiln/http/static_files.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "raykiln/api/etag.hpp"

namespace raykiln::server {
namespace {

TEST(StaticFiles, ServesAndRevalidates) {
  StaticFiles files;
  files.add("main.js", "let a;");
  const auto found = files.get("main.js", nullptr);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->status, 200);
  EXPECT_EQ(found->content_type, "text/javascript; charset=utf-8");
  EXPECT_EQ(*found->body, "let a;");
  const auto* etag = find_value(found->headers, "ETag");
  ASSERT_NE(etag, nullptr);
  EXPECT_EQ(files.get("main.js", etag)->status, 304);
  EXPECT_FALSE(files.get("../main.js", nullptr));
}

TEST(StaticFiles, ReadsAFolderWithoutLinks) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / "raykiln_static_files";
  fs::remove_all(folder);
  fs::create_directories(folder / "assets");
  std::ofstream(folder / "index.html") << "page";
  std::ofstream(folder / "assets" / "a.css") << "css";
  fs::create_symlink("/etc/passwd", folder / "secret.txt");
  StaticFiles files;
  EXPECT_TRUE(files.add_directory(folder));
  EXPECT_TRUE(files.get("index.html", nullptr));
  EXPECT_TRUE(files.get("assets/a.css", nullptr));
  EXPECT_FALSE(files.get("secret.txt", nullptr));
  EXPECT_FALSE(files.add_directory(folder / "absent"));
  fs::remove_all(folder);
}

TEST(Etag, ComparesLists) {
  EXPECT_TRUE(etag_matches("\"a\"", "\"a\""));
  EXPECT_TRUE(etag_matches("\"b\", W/\"a\" ", "\"a\""));
  EXPECT_TRUE(etag_matches("*", "\"a\""));
  EXPECT_FALSE(etag_matches("\"ab\"", "\"a\""));
  EXPECT_FALSE(etag_matches("", "\"a\""));
}

}  // namespace
}  // namespace raykiln::server
