// The scenes of a batch on their way to a server.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "../remote.hpp"
#include "batch_result.hpp"

namespace raykiln::server {

class BatchScenes {
 public:
  /// Reads and hashes every scene once; fills the digests of the results. A scene that cannot be read fails its own
  /// pictures alone: state and reason are in the results then.
  explicit BatchScenes(BatchResult& result);

  /// Asks what the server lacks and sends that. Scenes that it refuses are remembered with the reason. False, and
  /// the failure is in `remote`, when it cannot be reached or refuses for another reason than the scene.
  [[nodiscard]] bool upload(Remote& remote);

  /// Why the server did not take the scene; empty: it did.
  [[nodiscard]] std::string refusal(const std::string& scene) const;

 private:
  [[nodiscard]] bool send(Remote& remote, const std::string& id);

  std::map<std::string, ScenePackage> packages_;  ///< by digest
  std::map<std::string, std::string> refusals_;
};

}  // namespace raykiln::server
