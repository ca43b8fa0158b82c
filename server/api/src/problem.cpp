#include "raykiln/api/problem.hpp"

#include "problem_value.hpp"

namespace raykiln::server {
namespace {

int status_of(const Error& error) {
  // One code, one status, whoever says it; the kind decides for those that are not listed.
  if (error.code == "invalid_parameter") return 400;
  if (error.code == "payload_too_large") return 413;
  switch (error.kind) {
    case ErrorKind::kInvalid:
    case ErrorKind::kUnsupported:
    case ErrorKind::kTooLarge: return 422;
    case ErrorKind::kNotFound: return 404;
    case ErrorKind::kConflict: return 409;
    case ErrorKind::kTooMany: return 429;
    case ErrorKind::kUnavailable: return 503;
    case ErrorKind::kStorageFull: return 507;
    case ErrorKind::kInternal: return 500;
  }
  return 500;
}

}  // namespace

std::string_view reason_phrase(int status) {
  switch (status) {
    case 100: return "Continue";
    case 200: return "OK";
    case 201: return "Created";
    case 202: return "Accepted";
    case 204: return "No Content";
    case 304: return "Not Modified";
    case 400: return "Bad Request";
    case 403: return "Forbidden";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 408: return "Request Timeout";
    case 409: return "Conflict";
    case 413: return "Content Too Large";
    case 414: return "URI Too Long";
    case 415: return "Unsupported Media Type";
    case 417: return "Expectation Failed";
    case 421: return "Misdirected Request";
    case 422: return "Unprocessable Content";
    case 429: return "Too Many Requests";
    case 431: return "Request Header Fields Too Large";
    case 500: return "Internal Server Error";
    case 503: return "Service Unavailable";
    case 505: return "HTTP Version Not Supported";
    case 507: return "Insufficient Storage";
    default: return "Unknown";
  }
}

Problem problem_of(const Error& error) {
  Problem problem{status_of(error), error.code, error.message, error.where};
  problem.retry_after_s = error.retry_after_s;
  const bool temporary = problem.status == 429 || problem.status == 503;
  if (!problem.retry_after_s && temporary) problem.retry_after_s = 2;
  if (error.code == "invalid_request") {
    problem.errors.push_back({error.where, "invalid_value", error.message});
    problem.where.clear();
  }
  return problem;
}

nlohmann::ordered_json problem_value(const Problem& problem) {
  nlohmann::ordered_json json{{"type", "about:blank#" + problem.code},
                              {"title", reason_phrase(problem.status)},
                              {"status", problem.status},
                              {"detail", problem.detail},
                              {"code", problem.code}};
  if (!problem.where.empty()) json["where"] = problem.where;
  for (const auto& error : problem.errors) {
    json["errors"].push_back(
        {{"pointer", error.pointer}, {"code", error.code}, {"detail", error.detail}});
  }
  return json;
}

nlohmann::ordered_json error_value(const std::optional<Error>& error) {
  return error ? problem_value(problem_of(*error)) : nlohmann::ordered_json(nullptr);
}

std::string error_text(const nlohmann::json& problem) {
  std::string text = problem.at("code").get<std::string>() + ": " + problem.at("detail").get<std::string>();
  const std::string where = problem.value("where", "");
  return where.empty() ? text : text + " (" + where + ')';
}

std::string problem_json(const Problem& problem) {
  // Text of strangers (names, parts of files) may hold anything: bad UTF-8 is replaced.
  return problem_value(problem).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Response to_response(const Problem& problem) {
  Response response;
  response.status = problem.status;
  response.content_type = "application/problem+json";
  response.headers.emplace_back("Cache-Control", "no-store");
  if (problem.retry_after_s) {
    response.headers.emplace_back("Retry-After", std::to_string(*problem.retry_after_s));
  }
  response.body = std::make_shared<const std::string>(problem_json(problem));
  return response;
}

}  // namespace raykiln::server
