// What a request wants read from files.
#pragma once

#include <string>
#include <vector>

#include "world-service/service/run_service.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe {

struct RequestedFile {
  std::string problem;  // why it could not be read; else:
  RequestedWorld world;
  std::vector<EntityReport> spawnables;
};

// REQUIRES: the command is kLoadWorld, kSpawn or kSpawnables.
RequestedFile ReadRequestedFile(const ServiceOptions& options, const ControlRequest& request);

}  // namespace troupe
