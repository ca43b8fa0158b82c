#include "raykiln/http/routes.hpp"

#include "raykiln/api/problem.hpp"

namespace raykiln::server {
namespace {

Handler file(const StaticFiles& files, std::string path) {
  return [&files, path = std::move(path)](const Request& request) -> Answer {
    auto found = files.get(path, find_value(request.headers, "if-none-match"));
    return found ? *found : to_response({404, "not_found", "no such file"});
  };
}

/// A batch is as large as a few requests of jobs.
constexpr std::size_t kBatchBodies = 4;

/// Files beside index.html, or below its assets folder.
Handler any_file(const StaticFiles& files) {
  return [&files](const Request& request) -> Answer {
    return file(files, request.path.substr(1))(request);
  };
}

}  // namespace

Router make_routes(Api& api, BatchApi& batches, const StaticFiles& files, std::size_t max_json_bytes) {
  Router table;
  const auto to = [&api](Answer (Api::*operation)(const Request&)) -> Handler {
    return [&api, operation](const Request& request) { return (api.*operation)(request); };
  };
  const auto into = [&api](UploadStart (Api::*operation)(const Request&)) -> UploadHandler {
    return [&api, operation](const Request& request) { return (api.*operation)(request); };
  };
  table.upload("POST", "/v1/scenes", into(&Api::create_scene));
  table.route("GET", "/v1/scenes", to(&Api::list_scenes));
  table.upload("PUT", "/v1/scenes/<scene>", into(&Api::put_scene));
  table.route("GET", "/v1/scenes/<scene>", to(&Api::get_scene));
  table.route("DELETE", "/v1/scenes/<scene>", to(&Api::delete_scene));
  table.route("POST", "/v1/scenes/<scene>/prepare", to(&Api::prepare_scene));

  table.route("POST", "/v1/jobs", to(&Api::create_job), max_json_bytes);
  table.route("GET", "/v1/jobs", to(&Api::list_jobs));
  table.route("GET", "/v1/jobs/<job>", to(&Api::get_job));
  table.route("GET", "/v1/jobs/<job>/accuracy", to(&Api::get_accuracy));
  table.route("POST", "/v1/jobs/<job>/extend", to(&Api::extend_job), max_json_bytes);
  table.route("POST", "/v1/quotes", to(&Api::create_quote), max_json_bytes);
  table.route("GET", "/v1/quotes/<job>", to(&Api::get_quote));
  table.route("POST", "/v1/jobs/<job>/cancel", to(&Api::cancel_job));
  table.route("GET", "/v1/jobs/<job>/events", to(&Api::watch_job));
  table.route("GET", "/v1/jobs/<job>/image", to(&Api::get_image));
  table.route("GET", "/v1/jobs/<job>/samples", to(&Api::replay_sample));

  const auto of_batch = [&batches](Answer (BatchApi::*operation)(const Request&)) -> Handler {
    return [&batches, operation](const Request& request) { return (batches.*operation)(request); };
  };
  table.route("POST", "/v1/batches", of_batch(&BatchApi::create_batch), kBatchBodies * max_json_bytes);
  table.route("GET", "/v1/batches", of_batch(&BatchApi::list_batches));
  table.route("GET", "/v1/batches/<batch>", of_batch(&BatchApi::get_batch));
  table.route("POST", "/v1/batches/<batch>/cancel", of_batch(&BatchApi::cancel_batch));
  table.route("POST", "/v1/batches/<batch>/rerun", of_batch(&BatchApi::rerun_batch));
  table.route("GET", "/v1/batches/<batch>/events", of_batch(&BatchApi::watch_batch));
  table.route("POST", "/v1/missing-scenes", of_batch(&BatchApi::missing_scenes), max_json_bytes);

  table.route("GET", "/livez", to(&Api::livez));
  table.route("GET", "/readyz", to(&Api::readyz));
  table.route("GET", "/metrics", to(&Api::metrics_text));

  table.route("GET", "/openapi.yaml", file(files, "openapi.yaml"));
  table.route("GET", "/", file(files, "index.html"));
  table.route("GET", "/jobs/<job>", file(files, "index.html"));
  table.route("GET", "/batches", file(files, "index.html"));
  table.route("GET", "/batches/<batch>", file(files, "index.html"));
  table.route("GET", "/<file>", any_file(files));
  table.route("GET", "/assets/<file>", any_file(files));
  return table;
}

}  // namespace raykiln::server
