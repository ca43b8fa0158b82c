#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "raykiln/base/calendar.hpp"
#include "raykiln/base/file_name.hpp"
#include "raykiln/base/ids.hpp"
#include "raykiln/base/log.hpp"
#include "raykiln/base/metrics.hpp"
#include "raykiln/base/record.hpp"
#include "raykiln/base/serial_thread.hpp"
#include "raykiln/base/sha256.hpp"

namespace raykiln::server {
namespace {

TEST(UtcTime, KnowsTheCalendar) {
  using namespace std::chrono;
  const UtcTime leap(sys_days{year{2024} / 2 / 29} + 23h + 59min + 59s + 999ms);
  EXPECT_EQ(leap.date, year{2024} / 2 / 29);
  EXPECT_EQ(leap.weekday, Thursday);
  EXPECT_EQ(leap.clock(), "23:59:59");
  const UtcTime before(system_clock::time_point{} - 1ms);
  EXPECT_EQ(before.date, year{1969} / 12 / 31);
  EXPECT_EQ(before.clock(), "23:59:59");
}

TEST(Ids, AreOpaqueUrlSafeAndDifferent) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = random_id("j_");
    EXPECT_EQ(id.size(), 28U);
    EXPECT_TRUE(is_plain_id(id));
    EXPECT_TRUE(seen.insert(id).second);
  }
  EXPECT_FALSE(is_plain_id(""));
  EXPECT_FALSE(is_plain_id("../x"));
  EXPECT_FALSE(is_sha256_hex(std::string(64, 'A')));
  EXPECT_TRUE(is_sha256_hex(std::string(64, 'a')));
}

TEST(Sha256, GivesTheKnownDigests) {  // FIPS 180-4 examples
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Sha256 hash;
  hash.update("a");
  hash.update("bc");
  EXPECT_EQ(to_hex(hash.finish()),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(FileNames, OnlyThoseThatStayInside) {
  const std::pair<const char*, bool> rows[] = {
      {"a.obj", true},    {"a/b.mtl", true}, {"..a/b..", true}, {"", false},     {"/a", false},
      {"../a", false},    {"a/../b", false}, {"a//b", false},   {"a/", false},   {"./a", false},
      {"a\\b", false},    {"C:/a", false},   {"a\nb", false},   {"a/..", false}, {"\x7f", false}};
  for (const auto& [name, safe] : rows) EXPECT_EQ(is_safe_file_name(name, 255), safe) << name;
  EXPECT_FALSE(is_safe_file_name(std::string(256, 'a'), 255));
  EXPECT_FALSE(is_safe_file_name(std::string_view("a\0b", 3), 255));
}

TEST(Record, ReadsBackWhatWasWritten) {
  RecordWriter writer;
  writer.text("name", "two\nlines \\ and more ");
  writer.text("name", "");
  writer.real("tenth", 0.1);
  writer.natural("big", UINT64_MAX);
  writer.integer("low", INT64_MIN);
  const auto reader = RecordReader::parse(writer.str());
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->list("name"), (std::vector<std::string>{"two\nlines \\ and more ", ""}));
  EXPECT_EQ(reader->real("tenth"), 0.1);
  EXPECT_EQ(reader->natural("big"), UINT64_MAX);
  EXPECT_EQ(reader->integer("low"), INT64_MIN);
  EXPECT_EQ(reader->integer("absent", 7), 7);
}

TEST(Record, RefusesDamage) {
  RecordWriter writer;
  writer.text("a", "b");
  const std::string whole = writer.str();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto cut = RecordReader::parse(whole.substr(0, n));
    EXPECT_TRUE(!cut || !cut->has("a")) << n;
  }
  EXPECT_FALSE(RecordReader::parse(whole + "x"));
  EXPECT_FALSE(RecordReader::parse(whole + "k bad\\q\n"));
}

TEST(Log, HostileTextForgesNoLine) {
  EXPECT_EQ(format_line("store", "added", {{"scene", "x\nlevel=error"}, {"bytes", 7}}),
            "module=store event=added scene=\"x\\x0alevel=error\" bytes=7");
}

TEST(Metrics, ShowsThePrometheusForm) {
  MetricsRegistry registry;
  registry.counter("a_total", "first", {{"route", "/x\"y"}}).add(2);
  registry.gauge("b", "second").set(-1.5);
  auto& histogram = registry.histogram("c_seconds", "third", {0.1, 1.0});
  for (const double v : {0.1, 0.5, 2.0}) histogram.observe(v);
  const std::string text = registry.prometheus_text();
  for (const char* line :
       {"# TYPE a_total counter\na_total{route=\"/x\\\"y\"} 2\n", "b -1.5\n",
        "c_seconds_bucket{le=\"0.1\"} 1\n", "c_seconds_bucket{le=\"1\"} 2\n",
        "c_seconds_bucket{le=\"+Inf\"} 3\n", "c_seconds_sum 2.6\n", "c_seconds_count 3\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
  EXPECT_THROW(registry.gauge("a_total", "first"), std::logic_error);
}

TEST(Metrics, LabelsAreBounded) {
  MetricsRegistry registry;
  for (int i = 0; i < 5000; ++i) registry.counter("a_total", "", {{"x", std::to_string(i)}}).add();
  const std::string text = registry.prometheus_text();
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 1004);
  EXPECT_NE(text.find("x=\"other\"} 4000"), std::string::npos);
}

TEST(SerialThread, RunsInOrderAndDrainsOnStop) {
  std::vector<int> order;
  {
    SerialThread thread("test");
    for (int i = 0; i < 100; ++i) thread.post([&order, i] { order.push_back(i); });
    thread.post_after(std::chrono::hours(1), [&order] { order.push_back(-1); });
    thread.stop();
    EXPECT_FALSE(thread.post([] {}));
  }
  ASSERT_EQ(order.size(), 100U);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

}  // namespace
}  // namespace raykiln::server
