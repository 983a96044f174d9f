#include "world-service/service/owner_permissions.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/base/installed_folder.h"

namespace troupe {

void RestrictRequests(const OwnerPermissions& permissions, const WorldDescription& world,
                      const std::vector<std::string>& files, ServiceOptions& options) {
  AllowedPaths allowed;
  if (!options.world_file.empty()) {  // as in a damaged recording
    allowed.Add(std::filesystem::absolute(options.world_file).parent_path().string());
  }
  for (const std::string& file : files) allowed.Add(file);
  if (const std::string worlds = InstalledWorldsFolder(); !worlds.empty()) allowed.Add(worlds);
  for (const std::string& path : permissions.files) allowed.Add(path);
  options.overrides.allowed = allowed;

  AllowedPaths libraries;
  for (const std::string& library : LibrariesOf(world)) libraries.Add(library);
  if (options.overrides.controller && NamesLibrary(*options.overrides.controller)) {
    libraries.Add(*options.overrides.controller);
  }
  for (const std::string& path : permissions.controllers) libraries.Add(path);
  options.libraries = libraries;
}

std::vector<std::string> LibrariesOf(const WorldDescription& world) {
  std::vector<std::string> libraries;
  for (const RobotDescription& robot : world.robots) {
    const std::string& name = robot.controller.name;
    if (NamesLibrary(name) && std::find(libraries.begin(), libraries.end(), name) == libraries.end()) {
      libraries.push_back(name);
    }
  }
  return libraries;
}

Status CheckLibraries(const WorldDescription& world, const AllowedPaths& libraries) {
  for (const RobotDescription& robot : world.robots) {
    const std::string& name = robot.controller.name;
    if (!NamesLibrary(name) || libraries.Resolve(name)) continue;
    return Error{{},
                 fmt::format("robot {}: controller library {} is not allowed, expected a library that the owner of the "
                             "run has allowed (--allow-controllers)",
                             robot.name, name)};
  }
  return Status();
}

}  // namespace troupe
