#include <fstream>
#include <iostream>

#include "raykiln/api/percent.hpp"
#include "raykiln/api/scene_json.hpp"
#include "raykiln/app/scene_package.hpp"
#include "remote.hpp"

namespace raykiln::server {
namespace {

constexpr std::string_view kBoundary = "raykiln-5f0c3d0e9a1b4c7d8e6f";
/// The answer comes after the import, which takes its time for large scenes.
constexpr auto kImportSilence = std::chrono::seconds(900);

/// Text and files one after another, as one body.
class BodyParts {
 public:
  void text(std::string text) {
    length_ += text.size();
    parts_.push_back({std::move(text), {}, 0});
  }
  void file(const BlobFile& file) {
    length_ += file.bytes;
    parts_.push_back({{}, file.path, file.bytes});
  }
  [[nodiscard]] std::uint64_t length() const { return length_; }

  std::size_t read(char* to, std::size_t room) {
    while (at_ < parts_.size()) {
      Part& part = parts_[at_];
      const std::size_t count = part.path.empty() ? read_text(part, to, room) : read_file(part, to, room);
      if (count > 0) return count;
      ++at_;
    }
    return 0;
  }

 private:
  struct Part {
    std::string text;
    std::filesystem::path path;
    std::uint64_t left = 0;
  };
  std::size_t read_text(const Part& part, char* to, std::size_t room) {
    const std::size_t count = part.text.copy(to, room, offset_);
    offset_ += count;
    if (count == 0) offset_ = 0;
    return count;
  }
  std::size_t read_file(Part& part, char* to, std::size_t room) {
    if (part.left == 0) return 0;
    if (!in_.is_open()) in_.open(part.path, std::ios::binary);
    const auto most = static_cast<std::streamsize>(std::min<std::uint64_t>(room, part.left));
    in_.read(to, most);
    const auto count = static_cast<std::size_t>(in_.gcount());
    part.left -= count;
    if (part.left == 0) {
      in_.close();
      in_.clear();
    }
    return count;
  }

  std::vector<Part> parts_;
  std::size_t at_ = 0, offset_ = 0;
  std::uint64_t length_ = 0;
  std::ifstream in_;
};

std::string quoted(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (c == '"' || c == '\\') out.push_back('\\');
    out.push_back(c);
  }
  return out;
}

BodyParts body_of(const ScenePackage& package) {
  BodyParts body;
  if (package.kind != SceneKind::kFiles) {
    body.file(package.files.front());
    return body;
  }
  const std::string dash = "--" + std::string(kBoundary);
  for (const auto& file : package.files) {
    body.text(dash + "\r\nContent-Disposition: form-data; name=\"file\"; filename=\"" +
              quoted(file.name) + "\"\r\nContent-Type: application/octet-stream\r\n\r\n");
    body.file(file);
    body.text("\r\n");
  }
  body.text(dash + "--\r\n");
  return body;
}

std::string content_type(SceneKind kind) {
  if (kind == SceneKind::kZip) return "application/zip";
  if (kind == SceneKind::kGlb) return "model/gltf-binary";
  return "multipart/form-data; boundary=" + std::string(kBoundary);
}

void say_warnings(Remote& remote, const CliOptions& options, const std::string& json) {
  const auto scene = parse_scene(json);
  if (!scene || options.quiet) return;
  for (const auto& warning : scene->warnings) remote.warn(warning);
}

}  // namespace

Result<ClientResponse> put_scene(const ServerAddress& server, const ScenePackage& package, const std::string& id) {
  BodyParts body = body_of(package);
  return HttpClient(server, kImportSilence)
      .upload("PUT", "/v1/scenes/" + id + "?name=" + percent_encode(package.name) +
                         (package.allow_missing ? "&allow_missing=true" : ""),
              {{"Content-Type", content_type(package.kind)}}, body.length(),
              [&body](char* to, std::size_t room) { return body.read(to, room); });
}

std::optional<std::string> upload_scene(Remote& remote, const CliOptions& options) {
  auto package = find_scene_files(options.scene);
  const auto wrong = [&](const Error& error) {
    remote.fail(ExitCode::kScene, error.message + " (" + error.where + ')');
    return std::nullopt;
  };
  if (!package) return wrong(package.error());
  package->allow_missing = options.allow_missing;
  const auto id = scene_id(*package);
  if (!id) return wrong(id.error());
  const std::string target = "/v1/scenes/" + *id;
  auto known = HttpClient(remote.address()).request("GET", target);
  if (known && known->status == 200) {
    say_warnings(remote, options, known->body);
    return *id;
  }
  if (!known) {
    static_cast<void>(remote.check(std::move(known)));  // prints, and sets the failure
    return std::nullopt;
  }
  auto answer = put_scene(remote.address(), *package, *id);
  if (answer && answer->status == 422) {
    remote.fail(ExitCode::kScene, problem_text(answer->body));
    return std::nullopt;
  }
  const auto response = remote.check(std::move(answer));
  if (!response) return std::nullopt;
  say_warnings(remote, options, response->body);
  return *id;
}

}  // namespace raykiln::server
