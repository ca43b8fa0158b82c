// The client against the real server.
#include "raykiln/app/http_client.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "raykiln/http/server.hpp"

namespace raykiln::server {
namespace {

class TwoEvents final : public EventFeed {
 public:
  void start(std::function<void()> wake) override { wake_ = std::move(wake); }
  FeedStep poll() override {
    ++count_;
    wake_();
    return {"id: " + std::to_string(count_) + "\n\n", count_ == 2};
  }

 private:
  std::function<void()> wake_;
  int count_ = 0;
};

class HttpClientTest : public testing::Test {
 protected:
  void SetUp() override {
    router_.route("POST", "/echo", [](const Request& request) -> Answer {
      Response response;
      response.content_type = "text/plain";
      response.body = std::make_shared<const std::string>(request.body);
      return response;
    }, 10'000'000);
    router_.route("GET", "/events", [](const Request&) -> Answer { return std::make_unique<TwoEvents>(); });
    ServerSettings settings;
    settings.port = 0;
    settings.sse.least_gap = std::chrono::milliseconds(1);
    server_ = std::make_unique<Server>(settings, Server::Parts{router_, clock_, metrics_, Log()});
    address_ = {"127.0.0.1", std::to_string(*server_->listen())};
    thread_ = std::thread([this] { server_->run(); });
  }
  void TearDown() override {
    server_->stop(std::chrono::milliseconds(500));
    thread_.join();
  }

  Router router_;
  SystemClock clock_;
  MetricsRegistry metrics_;
  std::unique_ptr<Server> server_;
  ServerAddress address_;
  std::thread thread_;
};

TEST_F(HttpClientTest, SendsAndReceives) {
  const std::string large(3'000'000, 'x');
  const auto answer = HttpClient(address_).request("POST", "/echo", {}, large);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->body, large);
}

TEST_F(HttpClientTest, TakesARefusalThatComesWhileItSends) {
  std::uint64_t left = 20'000'000;
  const auto answer = HttpClient(address_).upload("POST", "/echo", {}, left, [&](char* to, std::size_t room) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(room, left));
    std::fill(to, to + count, 'x');
    left -= count;
    return count;
  });
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 413);
}

TEST_F(HttpClientTest, FollowsAStream) {
  std::string all;
  const auto answer = HttpClient(address_).stream("/events", {}, [&](std::string_view bytes) {
    all += bytes;
    return true;
  });
  ASSERT_TRUE(answer);
  EXPECT_EQ(all, "retry: 2000\n\nid: 1\n\nid: 2\n\n");
}

TEST(HttpClient, SaysThatNobodyIsThere) {
  const auto answer = HttpClient({"127.0.0.1", "1"}).request("GET", "/");
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, "no_server");
}

TEST(ServerUrl, IsParsed) {
  EXPECT_EQ(parse_server_url("http://localhost:8080")->port, "8080");
  EXPECT_EQ(parse_server_url("http://[::1]:1/")->host, "::1");
  EXPECT_EQ(parse_server_url("http://a")->port, "80");
  for (const char* text : {"", "localhost:8080", "https://a", "http://", "ftp://a"}) {
    EXPECT_FALSE(parse_server_url(text)) << text;
  }
}

}  // namespace
}  // namespace raykiln::server
