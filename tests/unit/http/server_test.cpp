// The real server on a free port, driven through raw sockets.
#include "raykiln/http/server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <thread>

namespace raykiln::server {
namespace {

using std::chrono::milliseconds;

/// A feed that a test fills by hand.
struct Channel {
  std::mutex mutex;
  std::function<void()> wake;
  std::string next;
  bool finished = false;

  void send(std::string event, bool last) {
    const std::lock_guard lock(mutex);
    next = std::move(event);
    finished = last;
    if (wake) wake();
  }
};

class ChannelFeed final : public EventFeed {
 public:
  explicit ChannelFeed(Channel& channel) : channel_(channel) {}
  ~ChannelFeed() override {
    const std::lock_guard lock(channel_.mutex);
    channel_.wake = nullptr;
  }
  void start(std::function<void()> wake) override {
    const std::lock_guard lock(channel_.mutex);
    channel_.wake = std::move(wake);
  }
  FeedStep poll() override {
    const std::lock_guard lock(channel_.mutex);
    return {std::exchange(channel_.next, {}), channel_.finished};
  }

 private:
  Channel& channel_;
};

Response text(int status, std::string body) {
  Response response;
  response.status = status;
  response.content_type = "text/plain";
  response.body = std::make_shared<const std::string>(std::move(body));
  return response;
}

/// With the patience of the daemon: a test that has to wait for a processor is not cut off.
class ServerTest : public testing::Test {
 protected:
  ServerTest() {
    settings_.port = 0;
    settings_.max_connections = 8;
    settings_.head_timeout = settings_.body_timeout = kPatience;
    settings_.sse = {milliseconds(1), milliseconds(200)};
  }
  void SetUp() override {
    router_.route("GET", "/hello", [](const Request&) -> Answer { return text(200, "hello"); });
    router_.route("POST", "/echo", [](const Request& r) -> Answer { return text(200, r.body); }, 1000);
    router_.route("GET", "/throw", [](const Request&) -> Answer { throw std::runtime_error("broken"); });
    router_.route("GET", "/big", [](const Request&) -> Answer { return text(200, std::string(3'000'000, 'x')); });
    router_.route("GET", "/events", [this](const Request&) -> Answer {
      return std::make_unique<ChannelFeed>(channel_);
    });
    server_ = std::make_unique<Server>(settings_, Server::Parts{router_, clock_, metrics_, Log()});
    port_ = *server_->listen();
    thread_ = std::thread([this] { server_->run(); });
  }
  void TearDown() override { stop(); }
  void stop(milliseconds drain = milliseconds(500)) {
    if (!thread_.joinable()) return;
    server_->stop(drain);
    thread_.join();
  }

  [[nodiscard]] int connect() const {
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const timeval limit{std::chrono::duration_cast<std::chrono::seconds>(kPatience).count(), 0};
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    return fd;
  }
  static void send(int fd, std::string_view bytes) {
    EXPECT_EQ(::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// Until the end of the connection, or until `mark` has come.
  static std::string receive(int fd, std::string_view mark = "") {
    std::string all;
    char piece[4096];
    while (mark.empty() || all.find(mark) == std::string::npos) {
      const auto count = recv(fd, piece, sizeof piece, 0);
      if (count <= 0) break;
      all.append(piece, static_cast<std::size_t>(count));
    }
    return all;
  }
  /// The answer until the end of the connection, or until `mark` has come.
  std::string exchange(std::string_view request, std::string_view mark = "") {
    const int fd = connect();
    send(fd, request);
    const auto answer = receive(fd, mark);
    close(fd);
    return answer;
  }
  static std::string get(const std::string& path, const std::string& more = "Connection: close\r\n") {
    return "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" + more + "\r\n";
  }

  static constexpr milliseconds kPatience{60'000};
  ServerSettings settings_;
  Router router_;
  SystemClock clock_;
  MetricsRegistry metrics_;
  Channel channel_;
  std::unique_ptr<Server> server_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

TEST_F(ServerTest, Answers) {
  const auto answer = exchange(get("/hello"));
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(answer.ends_with("\r\n\r\nhello"));
}

TEST_F(ServerTest, AnswersPipelinedRequestsInOrder) {
  const auto answer = exchange("POST /echo HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\none"
                               "POST /echo HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"
                               "3\r\ntwo\r\n0\r\n\r\n" + get("/hello"));
  const auto one = answer.find("\r\n\r\none"), two = answer.find("\r\n\r\ntwo"), three = answer.find("\r\n\r\nhello");
  EXPECT_LT(one, two);
  EXPECT_LT(two, three);
  EXPECT_NE(three, std::string::npos);
}

TEST_F(ServerTest, HeadHasNoBody) {
  const auto answer = exchange("HEAD /hello HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_NE(answer.find("Content-Length: 5\r\n"), std::string::npos);
  EXPECT_TRUE(answer.ends_with("\r\n\r\n"));
}

TEST_F(ServerTest, RefusesWithTheRightStatus) {
  const std::pair<std::string, std::string> rows[] = {
      {get("/nothing"), "404"},
      {"PUT /hello HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", "405"},
      {"GET /hello HTTP/1.1\r\nHost: evil.example\r\n\r\n", "421"},
      {"GET /hello HTTP/1.1\r\n\r\n", "400"},
      {"POST /echo HTTP/1.1\r\nHost: localhost\r\nOrigin: http://evil.example\r\nContent-Length: 0\r\n\r\n", "403"},
      {"POST /echo HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000\r\n\r\n", "413"},
      {"POST /echo HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n3;x=y\r\nabc\r\n0\r\n\r\n", "400"},
      {"GET /hello?a=%zz HTTP/1.1\r\nHost: localhost\r\n\r\n", "400"},
      {get("/throw"), "500"},
  };
  for (const auto& [request, status] : rows) {
    EXPECT_EQ(exchange(request, "\r\n\r\n").substr(0, 12), "HTTP/1.1 " + status) << request;
  }
}

/// Cuts off who takes more than 0.3 s for a head or a body.
class ImpatientServerTest : public ServerTest {
 protected:
  ImpatientServerTest() { settings_.head_timeout = settings_.body_timeout = milliseconds(300); }
};

TEST_F(ImpatientServerTest, CutsOffWhoIsTooSlow) {
  EXPECT_TRUE(exchange("POST /echo HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nabc").starts_with("HTTP/1.1 408"));
  EXPECT_TRUE(exchange("GET /hello HT").starts_with("HTTP/1.1 408"));
}

TEST_F(ServerTest, SaysContinueOnlyWhenTheBodyIsWanted) {
  const int fd = connect();
  send(fd, "POST /echo HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n");
  EXPECT_EQ(receive(fd, "\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
  send(fd, "ok");
  EXPECT_TRUE(receive(fd, "ok").ends_with("\r\n\r\nok"));
  close(fd);
  const auto answer = exchange(
      "POST /echo HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: 5000\r\n\r\n");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 413"));
}

TEST_F(ServerTest, SendsLargeAnswersWhole) { EXPECT_GT(exchange(get("/big")).size(), 3'000'000U); }

TEST_F(ServerTest, StreamsEventsToTheLast) {
  const int fd = connect();
  channel_.send("id: 1\n\n", false);
  send(fd, get("/events"));
  EXPECT_NE(receive(fd, "id: 1\n\n").find("retry: 2000\n\nid: 1\n\n"), std::string::npos);
  // One, or those of all the time that this thread was away.
  EXPECT_TRUE(receive(fd, ": heartbeat\n\n").starts_with(": heartbeat\n\n"));
  channel_.send("id: 2\n\n", true);
  EXPECT_TRUE(receive(fd).ends_with("id: 2\n\n"));
  close(fd);
}

TEST_F(ServerTest, SurvivesReadersThatGoAway) {
  for (int i = 0; i < 20; ++i) {
    const int fd = connect();
    send(fd, get(i % 2 == 0 ? "/events" : "/big"));
    close(fd);
  }
  // Until the server has seen them go it may have no connection to give: that is a 503, not a hang.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::string answer;
  while (!answer.ends_with("hello") && std::chrono::steady_clock::now() < deadline) {
    answer = exchange(get("/hello"));
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 200") || answer.starts_with("HTTP/1.1 503")) << answer;
  }
  EXPECT_TRUE(answer.ends_with("hello"));
}

TEST_F(ServerTest, HasABoundOnConnections) {
  std::vector<int> open;
  for (int i = 0; i < 8; ++i) {
    open.push_back(connect());
    send(open.back(), get("/hello", ""));
    EXPECT_TRUE(receive(open.back(), "hello").ends_with("hello"));
  }
  EXPECT_TRUE(exchange(get("/hello")).starts_with("HTTP/1.1 503"));
  for (const int fd : open) close(fd);
}

TEST_F(ServerTest, StopEndsStreamsAndIdleConnections) {
  const int idle = connect(), stream = connect();
  send(idle, get("/hello", ""));
  receive(idle, "hello");
  send(stream, get("/events"));
  receive(stream, "retry: 2000\n\n");
  // It does not wait for them to go by themselves.
  const auto begun = std::chrono::steady_clock::now();
  stop(4 * kPatience);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, kPatience);
  receive(idle);
  receive(stream);
  close(idle);
  close(stream);
}

}  // namespace
}  // namespace raykiln::server
