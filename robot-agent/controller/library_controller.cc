#include "robot-agent/controller/library_controller.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <system_error>

namespace troupe {
namespace {

Error LibraryError(const std::string& path, const std::string& message) {
  return {{}, fmt::format("controller library {}: {}", path, message)};
}

}  // namespace

Result<std::unique_ptr<Controller>> CreateLibraryController(const std::string& path, const RobotInfo& info,
                                                            const AllowedPaths& allowed) {
  // The path comes with the description of the world, which another process may have sent.
  const std::optional<std::string> resolved = allowed.Resolve(path);
  if (!resolved) {
    return LibraryError(path,
                        "is not allowed, expected a library that the owner of the run has allowed "
                        "(--allow-controllers)");
  }
  // dlopen would search the system's library folders for a bare name.
  std::error_code ignored;
  const std::string absolute = std::filesystem::absolute(*resolved, ignored).string();
  if (!std::filesystem::exists(absolute, ignored)) return LibraryError(path, "no such file: " + absolute);
  void* library = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) return LibraryError(path, fmt::format("cannot be opened: {}", dlerror()));

  using AbiFunction = int();
  using CreateFunction = Controller*(const RobotInfo&);
  auto* abi = reinterpret_cast<AbiFunction*>(dlsym(library, "troupe_controller_abi"));
  auto* create = reinterpret_cast<CreateFunction*>(dlsym(library, "troupe_create_controller"));
  if (abi == nullptr || create == nullptr) {
    return LibraryError(path,
                        "is not a controller: it lacks troupe_controller_abi or troupe_create_controller, expected "
                        "TROUPE_CONTROLLER(Type) in its source");
  }
  if (const int found = abi(); found != TROUPE_CONTROLLER_ABI) {
    return LibraryError(path, fmt::format("found interface version {}, expected {}: build it against this version of "
                                          "Troupe",
                                          found, TROUPE_CONTROLLER_ABI));
  }
  try {
    std::unique_ptr<Controller> controller(create(info));
    if (controller == nullptr) return LibraryError(path, "made no controller");
    return controller;
  } catch (const std::exception& exception) {
    return LibraryError(path, exception.what());
  } catch (...) {
    return LibraryError(path, "threw something that is not a std::exception");
  }
}

}  // namespace troupe
