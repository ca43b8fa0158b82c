#include "raykiln/http/router.hpp"

#include <gtest/gtest.h>

namespace raykiln::server {
namespace {

Handler nothing() {
  return [](const Request&) -> Answer { return Response{}; };
}

Router table() {
  Router router;
  router.route("GET", "/v1/jobs", nothing());
  router.route("POST", "/v1/jobs", nothing(), 100);
  router.route("GET", "/v1/jobs/<id>", nothing());
  router.route("POST", "/v1/jobs/<id>/cancel", nothing());
  router.route("GET", "/", nothing());
  router.route("GET", "/<file>", nothing());
  router.route("GET", "/livez", nothing());
  return router;
}

/// Pattern of the route that is found, or the methods that are allowed.
std::string find(const Router& router, const char* method, std::vector<std::string> segments) {
  const auto found = router.find(method, segments);
  if (const auto* match = std::get_if<Match>(&found)) {
    std::string text = match->route->pattern;
    for (const auto& [name, value] : match->parameters) text += ' ' + name + '=' + value;
    return text;
  }
  std::string text = "allow";
  for (const auto& allowed : std::get<NoMatch>(found).allowed_methods) text += ' ' + allowed;
  return text;
}

TEST(Router, FindsRoutes) {
  const Router router = table();
  EXPECT_EQ(find(router, "GET", {"v1", "jobs", "j_1"}), "/v1/jobs/<id> id=j_1");
  EXPECT_EQ(find(router, "HEAD", {"v1", "jobs"}), "/v1/jobs");
  EXPECT_EQ(find(router, "POST", {"v1", "jobs", "a", "cancel"}), "/v1/jobs/<id>/cancel id=a");
  EXPECT_EQ(find(router, "GET", {""}), "/");
  EXPECT_EQ(find(router, "GET", {"main.js"}), "/<file> file=main.js");
}

TEST(Router, PrefersLiterals) { EXPECT_EQ(find(table(), "GET", {"livez"}), "/livez"); }

TEST(Router, TellsWhatIsAllowed) {
  const Router router = table();
  EXPECT_EQ(find(router, "DELETE", {"v1", "jobs"}), "allow GET HEAD POST");
  EXPECT_EQ(find(router, "GET", {"v1", "jobs", "a", "cancel"}), "allow POST");
  EXPECT_EQ(find(router, "get", {"v1", "jobs"}), "allow GET HEAD POST");
  EXPECT_EQ(find(router, "GET", {"v1", "nothing", "here"}), "allow");
  EXPECT_EQ(find(router, "GET", {"v1", "jobs", ""}), "allow");
}

}  // namespace
}  // namespace raykiln::server
