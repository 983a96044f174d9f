// OwnerPermissions: the files and controller libraries that the requests of other processes may name.
#pragma once

#include <string>
#include <vector>

#include "world-service/service/run_service.h"
#include "worldfile/load_world.h"

namespace troupe {

// The settings of a command line: files, or folders with everything below them.
struct OwnerPermissions {
  std::vector<std::string> files;        // worlds and models, with the files that these include
  std::vector<std::string> controllers;  // libraries
};

// Restricts the requests of a run: they may name the permitted files, those below the folder of the run's own file,
// those that it has read, and the installed worlds; as controllers the permitted libraries and those of its own robots.
// `world`, `files`: that of the run, and those that were read for it. REQUIRES: world_file and overrides of the options
// are set.
void RestrictRequests(const OwnerPermissions& permissions, const WorldDescription& world,
                      const std::vector<std::string>& files, ServiceOptions& options);

// The names of controllers of `world` that are libraries, each once, in the order of the robots.
std::vector<std::string> LibrariesOf(const WorldDescription& world);

// The error names the first robot of a requested world that has a library for a controller that is not allowed.
Status CheckLibraries(const WorldDescription& world, const AllowedPaths& libraries);

}  // namespace troupe
