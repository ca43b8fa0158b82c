// Archives of strangers.
#include "raykiln/workers/archive.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>

#include <fstream>

#include "raykiln/workers/scene_intake.hpp"
#include "support/temp_directory.hpp"

namespace raykiln::server {
namespace {

namespace fs = std::filesystem;

struct Entry {
  std::string name, bytes;
  unsigned type = AE_IFREG;
  std::string link{};
};

void write_zip(const fs::path& path, const std::vector<Entry>& entries, const char* options = nullptr) {
  archive* a = archive_write_new();
  archive_write_set_format_zip(a);
  if (options != nullptr) {
    ASSERT_EQ(archive_write_set_options(a, options), ARCHIVE_OK);
    archive_write_set_passphrase(a, "secret");
  }
  ASSERT_EQ(archive_write_open_filename(a, path.c_str()), ARCHIVE_OK);
  for (const Entry& e : entries) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, e.name.c_str());
    archive_entry_set_filetype(entry, e.type);
    archive_entry_set_perm(entry, 0644);
    if (e.type == AE_IFLNK) archive_entry_set_symlink(entry, e.link.c_str());
    if (e.type == AE_IFREG) archive_entry_set_size(entry, static_cast<la_int64_t>(e.bytes.size()));
    ASSERT_EQ(archive_write_header(a, entry), ARCHIVE_OK) << archive_error_string(a);
    if (!e.bytes.empty()) archive_write_data(a, e.bytes.data(), e.bytes.size());
    archive_entry_free(entry);
  }
  archive_write_close(a);
  archive_write_free(a);
}

struct ArchiveTest : testing::Test {
  tests::TempDirectory directory;
  fs::path zip = directory.path() / "a.zip";
  UploadLimits limits;
  int runs = 0;

  Result<std::vector<BlobFile>> unpack() {
    std::string folder = std::to_string(++runs);
    folder += "-out";
    const auto to = directory.path() / folder;
    fs::create_directories(to);
    return unpack_zip(zip, to, limits, {});
  }
  std::string code() {
    const auto result = unpack();
    return result ? "" : result.error().code;
  }
};

TEST_F(ArchiveTest, UnpacksFilesUnderNumbers) {
  write_zip(zip, {{"dir/", "", AE_IFDIR}, {"dir/a.obj", "v 0 0 0\n"}, {"b.mtl", ""}});
  const auto files = unpack();
  ASSERT_TRUE(files) << files.error().message;
  ASSERT_EQ(files->size(), 2U);
  EXPECT_EQ(files->at(0).name, "dir/a.obj");
  EXPECT_EQ(files->at(0).path.filename(), "0");
  EXPECT_EQ(files->at(0).bytes, 8U);
}

TEST_F(ArchiveTest, RefusesNamesThatLeave) {
  for (const char* name : {"../a", "/etc/passwd", "a/../../b", "..\\a", "C:/x"}) {
    write_zip(zip, {{name, "x"}});
    EXPECT_EQ(code(), "unsafe_name") << name;
  }
  write_zip(zip, {{"a", "x"}, {"a", "y"}});
  EXPECT_EQ(code(), "unsafe_name");
}

TEST_F(ArchiveTest, RefusesLinksAndEncryption) {
  write_zip(zip, {{"a", "", AE_IFLNK, "/etc/passwd"}});
  EXPECT_EQ(code(), "archive_invalid");
  write_zip(zip, {{"a", "some text"}}, "zip:encryption=traditional");
  EXPECT_EQ(code(), "archive_invalid");
}

TEST_F(ArchiveTest, RefusesTruncationAnywhereAndRubbish) {
  write_zip(zip, {{"a.obj", std::string(5000, 'v')}, {"b.obj", "more of it"}});
  const auto whole = fs::file_size(zip);
  for (auto cut = whole - 1; cut > 0; cut = cut > 7 ? cut - 7 : 0) {
    fs::resize_file(zip, cut);
    EXPECT_NE(code(), "") << cut;
  }
  std::ofstream(zip) << "this is no archive at all";
  EXPECT_EQ(code(), "archive_invalid");
  std::ofstream(zip, std::ios::trunc).close();
  EXPECT_EQ(code(), "archive_invalid");
}

TEST_F(ArchiveTest, RefusesBombsAndTooMuch) {
  write_zip(zip, {{"zeros", std::string(32 << 20, '\0')}});
  limits.max_unpack_ratio = 500.0;
  EXPECT_EQ(code(), "archive_too_large");
  limits = {};
  limits.max_unpacked_bytes = 1 << 20;
  EXPECT_EQ(code(), "archive_too_large");
  limits = {};
  limits.max_entries = 2;
  write_zip(zip, {{"a", "1"}, {"b", "2"}, {"c", "3"}});
  EXPECT_EQ(code(), "archive_too_large");
  write_zip(zip, {{"dir/", "", AE_IFDIR}});
  EXPECT_EQ(code(), "scene_empty");
}

TEST_F(ArchiveTest, IntakeReadsASceneAndLeavesNothingUnpacked) {
  const auto scratch = directory.path() / "scratch";
  const auto intake = make_scene_intake(limits, [&]() -> Result<fs::path> {
    fs::create_directories(scratch / "x");
    return scratch / "x";
  });
  const auto load = [&](const std::string& obj) {
    write_zip(zip, {{"a.obj", obj}});
    return intake->load(SceneKind::kZip, {{"a.zip", zip, fs::file_size(zip)}}, MissingTextures::kRefuse, {});
  };
  const auto good = load("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_TRUE(good) << good.error().message;
  EXPECT_EQ(good->report.triangles, 1U);
  EXPECT_FALSE(good->report.cameras.empty());
  const auto back = decode_report(encode_report(good->report));
  ASSERT_TRUE(back);
  EXPECT_EQ(encode_report(*back), encode_report(good->report));
  EXPECT_EQ(load("v 0 0 0\n").error().code, "scene_empty");
  const auto bad = load("v 0 0 0\nv nan 0 0\n");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, "scene_invalid");
  EXPECT_EQ(bad.error().where, "a.obj:2");
  EXPECT_TRUE(fs::is_empty(scratch));
}

}  // namespace
}  // namespace raykiln::server
