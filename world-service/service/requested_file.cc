#include "world-service/service/requested_file.h"

#include <exception>
#include <string_view>
#include <utility>

#include "common/worldfile/spawnable.h"

namespace troupe {
namespace {

// What went wrong, and where: the reader says that it is an error.
RequestedFile Failure(const Error& error) {
  constexpr std::string_view kSeverity = "error: ";
  std::string text = error.ToString();
  text.erase(text.find(kSeverity), kSeverity.size());
  return {std::move(text), nullptr, {}};
}

RequestedFile ListModels(const ServiceOptions& options) {
  const Result<std::vector<Spawnable>> models = ListSpawnables(options.world_file);
  if (!models.ok()) return Failure(models.error());
  RequestedFile file;
  for (const Spawnable& model : models.value()) {
    const EntityKind kind = model.type == "position" ? EntityKind::kRobot : EntityKind::kModel;
    file.spawnables.push_back({.name = model.name, .type = model.type, .kind = kind});
  }
  return file;
}

RequestedFile Read(const ServiceOptions& options, const ControlRequest& request) {
  if (request.command == ControlCommand::kSpawnables) return ListModels(options);
  Result<LoadedWorld> loaded = request.command == ControlCommand::kLoadWorld
                                   ? LoadWorld(request.source, options.overrides)
                                   : LoadSpawnable(options.world_file, request.source, options.overrides);
  if (!loaded.ok()) return Failure(loaded.error());
  return {"", std::make_shared<const WorldDescription>(std::move(loaded.value().world)), {}};
}

}  // namespace

RequestedFile ReadRequestedFile(const ServiceOptions& options, const ControlRequest& request) {
  try {
    return Read(options, request);
  } catch (const std::exception& exception) {  // as a file system that fails
    return {exception.what(), nullptr, {}};
  }
}

}  // namespace troupe
