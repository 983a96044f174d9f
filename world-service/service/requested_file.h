// The files of a request: a world to load, a model to spawn, or the list of such models.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "troupe/result.h"
#include "world-service/service/run_control.h"
#include "world-service/service/run_service.h"

namespace troupe {

// The text of a request as a file, which the readers of worlds expect. Deleted with the last copy.
class RequestedText {
 public:
  // A scenario begins with a brace; any other text is a Stage world.
  static Result<std::shared_ptr<const RequestedText>> Write(const std::string& text);
  ~RequestedText();
  RequestedText(const RequestedText&) = delete;
  RequestedText& operator=(const RequestedText&) = delete;

  const std::string& path() const { return path_; }

 private:
  explicit RequestedText(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;
  std::string path_;
};

struct RequestedFile {
  RequestedWorld world;                                // of kLoadWorld and kSpawn
  std::vector<EntityReport> listed;                    // of kSpawnables and kWorlds
  std::shared_ptr<const RequestedText> text = {};      // of kLoadWorld with a text
  std::optional<std::uint32_t> ros_domains_from = {};  // of kSpawn, ControlRequest::ros_domains_from
};

// The error's message has the place in the file. REQUIRES: the command is kLoadWorld, kSpawn, kSpawnables or kWorlds.
Result<RequestedFile> ReadRequestedFile(const ServiceOptions& options, const ControlRequest& request);

}  // namespace troupe
