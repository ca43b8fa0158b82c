#include <gtest/gtest.h>

#include "raykiln/api/batch_json.hpp"
#include "raykiln/api/picture_name.hpp"

namespace raykiln::server {
namespace {

const std::string kScene(64, 'a');

BatchRequest good() {
  BatchRequest batch{.name = "n", .priority = 7, .max_active = 3, .fail_fast = true, .reuse = false};
  for (const char* name : {"one", "two"}) {
    BatchItem item;
    item.name = name;
    item.request.scene = kScene;
    item.request.name = name;
    item.request.camera = OwnCamera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30.0};
    item.request.stop.error = 0.02;
    item.request.max_depth = 4;
    batch.items.push_back(item);
  }
  return batch;
}

Problem problem(const std::string& body) {
  auto parsed = parse_batch_request(body, {});
  const auto* found = std::get_if<Problem>(&parsed);
  return found != nullptr ? *found : Problem{};
}

std::string entry(const std::string& more) {
  return "{\"scene\":\"" + kScene + "\",\"name\":\"a\"" + more + "}";
}
std::string body(const std::string& entries, const std::string& more = "") {
  return "{\"defaults\":{\"width\":8,\"height\":8,\"stop\":{\"samples\":1}},\"scenes\":[" + entries + "]" + more + "}";
}

TEST(BatchJson, ARequestComesBackAsItWent) {
  auto parsed = parse_batch_request(batch_request_json(good()), {});
  const auto* batch = std::get_if<BatchRequest>(&parsed);
  ASSERT_NE(batch, nullptr) << std::get<Problem>(parsed).detail;
  EXPECT_EQ(batch_digest(*batch), batch_digest(good()));
  EXPECT_EQ(batch->items[1].name, "two");
}

TEST(BatchJson, TheMatrixIsSpreadOut) {
  auto parsed = parse_batch_request(
      body(entry(R"(,"cameras":[1,"top",{"name":"own","eye":[0,0,5],"look_at":[0,0,0]}],"settings":[{},{"name":"b c","seed":2}])")), {});
  const auto* batch = std::get_if<BatchRequest>(&parsed);
  ASSERT_NE(batch, nullptr) << std::get<Problem>(parsed).detail;
  std::vector<std::string> names;
  for (const auto& item : batch->items) names.push_back(item.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a-1", "a-1-b_c", "a-top", "a-top-b_c", "a-own", "a-own-b_c"}));
  EXPECT_EQ(std::get<int>(batch->items[1].request.camera), 1);
  EXPECT_EQ(batch->items[1].request.seed, 2U);
  EXPECT_EQ(std::get<OwnCamera>(batch->items[4].request.camera).eye[2], 5.0);
  EXPECT_EQ(batch->items[5].request.name, "a-own-b_c");
}

TEST(BatchJson, SaysWhatIsWrongAndWhere) {
  const std::pair<std::string, const char*> rows[] = {
      {body(entry(",\"cameras\":[null]")), "/scenes/0/camera"},
      {body(entry(",\"cameras\":[]")), "/scenes/0/cameras"},
      {body(entry(",\"settings\":[3]")), "/scenes/0/settings/0"},
      {body(entry(",\"settings\":[{\"stop\":{\"tile_samples\":[1]}}]")), "/scenes/0/settings/0/stop/tile_samples"},
      {body(entry(",\"settings\":[{\"reuse\":true}]")), "/scenes/0/settings/0/reuse"},
      {body(entry(",\"colour\":1")), "/scenes/0/colour"},
      {body(entry("") + "," + entry("")), "/scenes/1"},
      {body("7"), "/scenes/0"},
      {body(entry(""), ",\"priority\":101"), "/priority"}};
  for (const auto& [text, pointer] : rows) {
    const Problem found = problem(text);
    ASSERT_FALSE(found.errors.empty()) << text;
    EXPECT_EQ(found.errors.front().pointer, pointer) << text;
    EXPECT_EQ(found.status, 422);
  }
  EXPECT_EQ(problem("[").status, 400);
  EXPECT_EQ(problem("[]").status, 422);
}

TEST(BatchJson, AnAnswerIsReadBack) {
  Batch batch("b_1", "", good(), {});
  batch.enter(0, ItemState::kCompleted);
  batch.item(0).job = "j_1";
  batch.mark_reused(0);
  batch.enter(1, ItemState::kFailed);
  batch.item(1).error = Error{ErrorKind::kNotFound, "scene_not_found", "there is no such scene", "x"};
  const auto view = parse_batch_view(batch_json(batch));
  ASSERT_TRUE(view);
  EXPECT_EQ(view->state, "failed");
  EXPECT_EQ(view->items[0].job, "j_1");
  EXPECT_TRUE(view->items[0].reused);
  EXPECT_EQ(view->items[1].error, "scene_not_found: there is no such scene (x)");
  EXPECT_FALSE(parse_batch_view("{}"));
}

TEST(PictureName, IsFitForAFile) {
  EXPECT_EQ(picture_name("a b/c", "", ""), "a_b_c");
  EXPECT_EQ(picture_name("../x", "0", "low"), "_._x-0-low");
  EXPECT_EQ(picture_name(std::string(300, 'x'), "", "").size(), 100U);
}

}  // namespace
}  // namespace raykiln::server
