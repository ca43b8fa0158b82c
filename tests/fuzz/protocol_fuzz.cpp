// Deterministic mutation fuzzing of what reads bytes from the network: heads, targets, chunks, forms,
// JSON requests. RAYKILN_FUZZ_ITERATIONS and RAYKILN_FUZZ_SEED change the amount and the start; run it
// under asan-ubsan. Beside "does not crash" each case states what must hold for any input.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <random>

#include "raykiln/api/job_json.hpp"
#include "raykiln/app/sse_reader.hpp"
#include "raykiln/http/body_decoder.hpp"
#include "raykiln/http/head.hpp"
#include "raykiln/http/multipart.hpp"
#include "raykiln/http/target.hpp"

namespace raykiln::server {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t fallback) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : fallback;
}

const std::vector<std::string> kPieces{
    "\r\n", "\r\n\r\n", "\n", "\r", ":", " ", "\t", "0", "-1", "99999999999999999999", "chunked", ";", ",", "%2e", "%",
    "/..", "?", "&", "=", "+", "--B", "--B--", "\"", "\\", "{", "}", "[", "null", "1e999", "\xFF", "Host: a\r\n",
    "Content-Length: 3\r\n", "Transfer-Encoding: chunked\r\n", std::string(1, '\0'), std::string(300, 'a')};

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random_() % n); }

  std::string operator()(std::string bytes) {
    for (std::size_t i = 0, steps = 1 + below(5); i < steps; ++i) step(bytes);
    return bytes;
  }

 private:
  void step(std::string& bytes) {
    const std::size_t at = below(bytes.size() + 1);
    switch (below(5)) {
      case 0: if (at < bytes.size()) bytes[at] = static_cast<char>(below(256)); break;
      case 1: bytes.resize(at); break;
      case 2: bytes.erase(at, 1 + below(20)); break;
      case 3: bytes.insert(at, kPieces[below(kPieces.size())]); break;
      default: bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(60))); break;
    }
  }
  std::mt19937_64 random_;
};

void fuzz(const std::vector<std::string>& seeds, const std::function<void(const std::string&, Mutator&)>& check) {
  const auto iterations = from_environment("RAYKILN_FUZZ_ITERATIONS", 20'000);
  const auto seed = from_environment("RAYKILN_FUZZ_SEED", 1);
  Mutator mutate(seed);
  for (std::uint64_t i = 0; i < iterations && !testing::Test::HasFailure(); ++i) {
    const std::string input = mutate(seeds[mutate.below(seeds.size())]);
    SCOPED_TRACE(testing::Message() << "seed " << seed << " iteration " << i);
    check(input, mutate);
  }
}

TEST(ProtocolFuzz, Heads) {
  fuzz({"GET / HTTP/1.1\r\nHost: a\r\nAccept: */*\r\n\r\n",
        "POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Length: 3\r\nExpect: 100-continue\r\n\r\n",
        "PUT /a HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\nConnection: close\r\n\r\n"},
       [](const std::string& input, Mutator&) {
         const auto parsed = parse_head(input);
         const auto* head = std::get_if<RequestHead>(&parsed);
         if (head == nullptr) return;
         // Framing is unambiguous: one length, or chunks, never both.
         EXPECT_FALSE(head->chunked && head->content_length.has_value());
         EXPECT_FALSE(head->chunked && head->http_1_0);
         for (const auto& [name, value] : head->headers) {
           EXPECT_EQ(value.find_first_of(std::string_view("\r\n\0", 3)), std::string::npos);
         }
       });
}

TEST(ProtocolFuzz, Targets) {
  fuzz({"/v1/jobs/j_1/image?format=png&rev=3", "/v1/scenes?name=a%20b", "/"},
       [](const std::string& input, Mutator&) {
         const auto target = parse_target(input);
         if (!target) return;
         EXPECT_LE(target->segments.size(), kMaxSegments);
         for (const auto& segment : target->segments) {
           EXPECT_TRUE(segment != "." && segment != "..");
           EXPECT_EQ(segment.find_first_of(std::string_view("/\\\0\r\n", 5)), std::string::npos);
         }
       });
}

TEST(ProtocolFuzz, ChunksDecodeTheSameHoweverTheyAreCut) {
  RequestHead head;
  head.chunked = true;
  fuzz({"5\r\nhello\r\n0\r\n\r\n", "a\r\n0123456789\r\n1\r\nx\r\n0\r\n\r\nrest"},
       [&](const std::string& input, Mutator& random) {
         const auto decode = [&](std::size_t piece) {
           BodyDecoder decoder(head);
           std::string payload;
           std::size_t at = 0;
           while (at < input.size() && !decoder.done() && !decoder.failed()) {
             const auto step = decoder.feed(std::string_view(input).substr(at, piece));
             payload += step.payload;
             at += step.consumed;
           }
           return std::make_tuple(payload, decoder.done(), decoder.failed(), decoder.done() ? at : 0);
         };
         EXPECT_EQ(decode(input.size()), decode(1 + random.below(5)));
       });
}

TEST(ProtocolFuzz, FormsParseTheSameHoweverTheyAreCut) {
  fuzz({"--B\r\nContent-Disposition: form-data; name=\"f\"; filename=\"a.obj\"\r\n\r\nv 0 0 0\r\n--B\r\n"
        "Content-Disposition: form-data; filename=b\r\nContent-Type: x\r\n\r\n\r\n--B--\r\n"},
       [](const std::string& input, Mutator& random) {
         const auto parse = [&](std::size_t piece) {
           std::string log;
           MultipartSink sink;
           sink.begin = [&](const std::string& name) { log += '<' + name + '>'; return true; };
           sink.bytes = [&](std::string_view bytes) { log += bytes; return true; };
           sink.end = [&] { log += "</>"; return true; };
           MultipartParser parser("B", sink);
           bool accepted = true;
           for (std::size_t at = 0; at < input.size() && accepted; at += piece) {
             accepted = parser.feed(std::string_view(input).substr(at, piece));
           }
           // Of a refused body only the refusal is promised: how much came before depends on the cut.
           return std::make_tuple(accepted, parser.complete(), accepted ? log : std::string());
         };
         const auto whole = parse(std::max<std::size_t>(input.size(), 1));
         const auto cut = parse(1 + random.below(7));
         EXPECT_EQ(std::get<0>(whole), std::get<0>(cut));
         if (std::get<1>(whole)) {
           EXPECT_EQ(whole, cut);
         }
       });
}

TEST(ProtocolFuzz, JobRequests) {
  const std::string scene(64, 'a');
  fuzz({"{\"scene\":\"" + scene + "\",\"width\":64,\"height\":48,\"stop\":{\"samples\":4}}",
        "{\"scene\":\"" + scene + "\",\"width\":1,\"height\":1,\"stop\":{\"samples\":1},\"camera\":{\"eye\":[0,0,1],"
        "\"look_at\":[0,0,0],\"up\":[0,1,0],\"fov_deg\":40},\"seed\":7,\"emitter_sampling\":false,\"name\":\"n\"}"},
       [](const std::string& input, Mutator&) {
         const auto parsed = parse_job_request(input, JobLimits{});
         if (const auto* problem = std::get_if<Problem>(&parsed)) {
           EXPECT_TRUE(problem->status == 400 || problem->status == 422);
           EXPECT_FALSE(problem_json(*problem).empty());
           return;
         }
         // What is taken can be written and read again.
         const auto text = job_request_json(std::get<JobRequest>(parsed));
         EXPECT_TRUE(std::holds_alternative<JobRequest>(parse_job_request(text, JobLimits{}))) << text;
       });
}

TEST(ProtocolFuzz, WhatAServerSendsToTheClient) {
  fuzz({"id: 1\nevent: job\ndata: {\"id\":\"j\"}\n\n: heartbeat\n\n"}, [](const std::string& input, Mutator&) {
    SseReader reader;
    const auto events = reader.feed(input);
    if (!events) return;
    for (const auto& event : *events) static_cast<void>(parse_job_view(event.data));
  });
}

}  // namespace
}  // namespace raykiln::server
