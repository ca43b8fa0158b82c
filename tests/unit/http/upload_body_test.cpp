#include "raykiln/http/upload_body.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

/// Writes down what it is told.
class Diary final : public Upload {
 public:
  explicit Diary(std::string& text) : text_(text) {}
  std::optional<Response> begin_file(const std::string& name) override {
    text_ += '<' + name + '>';
    if (name != "refused") return std::nullopt;
    Response response;
    response.status = 422;
    return response;
  }
  std::optional<Response> write(std::span<const char> bytes) override {
    text_.append(bytes.data(), bytes.size());
    return std::nullopt;
  }
  std::optional<Response> end_file() override {
    text_ += "</>";
    return std::nullopt;
  }
  Response finish() override {
    Response response;
    response.status = 201;
    return response;
  }

 private:
  std::string& text_;
};

RequestHead head_of(std::size_t length, const std::string& type) {
  RequestHead head;
  head.content_length = length;
  head.headers = {{"content-type", type}};
  return head;
}

struct Outcome {
  std::string diary;
  int status = 0;
  std::size_t consumed = 0;
};

Outcome upload(const RequestHead& head, bool multipart, std::string_view bytes, std::uint64_t max = 1000) {
  Outcome outcome;
  UploadBody body(head, {std::make_unique<Diary>(outcome.diary), multipart, max});
  const auto progress = body.feed(bytes);
  outcome.consumed = progress.consumed;
  if (progress.refusal) outcome.status = progress.refusal->status;
  else if (progress.done) outcome.status = body.finish().status;
  return outcome;
}

const std::string kForm = "multipart/form-data; boundary=B";

std::string form(const std::string& name) {
  return "--B\r\nContent-Disposition: form-data; name=a; filename=" + name + "\r\n\r\nxyz\r\n--B--\r\n";
}

TEST(UploadBody, PassesOneFileOn) {
  const auto outcome = upload(head_of(5, "application/zip"), false, "helloGET");
  EXPECT_EQ(outcome.diary, "hello");
  EXPECT_EQ(outcome.status, 201);
  EXPECT_EQ(outcome.consumed, 5U);
}

TEST(UploadBody, TakesFormsApart) {
  const auto text = form("a.obj");
  const auto outcome = upload(head_of(text.size(), kForm), true, text);
  EXPECT_EQ(outcome.diary, "<a.obj>xyz</>");
  EXPECT_EQ(outcome.status, 201);
}

TEST(UploadBody, RefusesBadForms) {
  const auto text = form("a.obj");
  EXPECT_EQ(upload(head_of(text.size() - 6, kForm), true, text).status, 400);  // no closing boundary
  EXPECT_EQ(upload(head_of(3, kForm), true, "xyz").status, 400);
  EXPECT_EQ(upload(head_of(text.size(), "multipart/form-data"), true, text).status, 400);
  EXPECT_EQ(upload(head_of(form("refused").size(), kForm), true, form("refused")).status, 422);
}

TEST(UploadBody, KeepsTheLimitWithoutALengthInTheHead) {
  RequestHead head = head_of(0, "application/zip");
  head.content_length.reset();
  head.chunked = true;
  EXPECT_EQ(upload(head, false, "4\r\nabcd\r\n4\r\nabcd\r\n", 8).status, 0);
  EXPECT_EQ(upload(head, false, "4\r\nabcd\r\n5\r\nabcde\r\n", 8).status, 413);
  EXPECT_EQ(upload(head, false, "4;x\r\nabcd\r\n", 8).status, 400);
}

}  // namespace
}  // namespace raykiln::server
