// What the commands that talk to a daemon share.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>

#include "raykiln/api/job_json.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/app/http_client.hpp"
#include "raykiln/app/progress.hpp"
#include "raykiln/app/scene_package.hpp"

namespace raykiln::server {

/// A connection's address and what to do with answers. `fail` prints and gives the exit code.
class Remote {
 public:
  /// Nothing, and a message, when the URL is wrong.
  [[nodiscard]] static std::optional<Remote> open(const CliOptions& options);

  /// The response when its status is 2xx; else nothing, a message, and the code is in `failure`.
  [[nodiscard]] std::optional<ClientResponse> ask(const std::string& method,
                                                  const std::string& target,
                                                  const ClientHeaders& headers = {},
                                                  const std::string& body = {});
  [[nodiscard]] std::optional<ClientResponse> check(Result<ClientResponse> response);

  /// Follows a job to its final state, over reconnections; nothing and `failure` otherwise.
  [[nodiscard]] std::optional<JobView> follow(const std::string& job, ProgressLine& line,
                                              std::string* last_json);

  /// Prints a warning, once: a scene's come with its upload and with its job. What a stranger named may hold anything, so
  /// that controls are left out.
  void warn(const std::string& message);

  [[nodiscard]] ExitCode failure() const { return failure_; }
  [[nodiscard]] const ServerAddress& address() const { return address_; }
  ExitCode fail(ExitCode code, const std::string& message);

 private:
  explicit Remote(ServerAddress address) : address_(std::move(address)) {}

  ServerAddress address_;
  ExitCode failure_ = ExitCode::kOk;
  std::set<std::string> warned_;
};

/// Text without controls.
[[nodiscard]] std::string clean(const std::string& text);

[[nodiscard]] ProgressState progress_of(const JobView& job);
[[nodiscard]] ExitCode exit_code_for_status(int status);
/// 0, kJobFailed or kJobCancelled.
[[nodiscard]] ExitCode exit_code_for_state(const std::string& state);

/// Makes the server have the scene; its id.
[[nodiscard]] std::optional<std::string> upload_scene(Remote& remote, const CliOptions& options);

/// Uploads the files of a scene under its id.
[[nodiscard]] Result<ClientResponse> put_scene(const ServerAddress& server, const ScenePackage& package,
                                               const std::string& id);

/// Downloads the newest picture into each of the outputs.
[[nodiscard]] ExitCode fetch_pictures(Remote& remote, const CliOptions& options,
                                      const std::string& job);

}  // namespace raykiln::server
