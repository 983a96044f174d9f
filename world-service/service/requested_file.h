// The files of a request: a world to load, a model to spawn, or the list of such models.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "troupe/result.h"
#include "world-service/service/requested_text.h"
#include "world-service/service/run_control.h"
#include "world-service/service/run_service.h"

namespace troupe {

struct RequestedFile {
  RequestedWorld world;                                // of kLoadWorld and kSpawn
  std::vector<EntityReport> listed;                    // of kSpawnables and kWorlds
  std::shared_ptr<const RequestedText> text = {};      // of kLoadWorld with a text
  std::optional<std::uint32_t> ros_domains_from = {};  // of kSpawn, ControlRequest::ros_domains_from
};

// The error's message has the place in the file. REQUIRES: the command is kLoadWorld, kSpawn, kSpawnables or kWorlds.
Result<RequestedFile> ReadRequestedFile(const ServiceOptions& options, const ControlRequest& request);

}  // namespace troupe
