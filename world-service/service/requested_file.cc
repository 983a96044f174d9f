#include "world-service/service/requested_file.h"

#include <exception>
#include <string_view>
#include <utility>

#include "common/worldfile/spawnable.h"
#include "world-service/service/owner_permissions.h"

namespace troupe {
namespace {

// The place and the message in one text, without the severity. A file that was not found has no line.
Error FlattenPlace(const Error& error) {
  constexpr std::string_view kSeverity = "error: ";
  std::string text = error.ToString();
  text.erase(text.find(kSeverity), kSeverity.size());
  const bool is_malformed = error.code == ErrorCode::kBadInput && error.where.line > 0;
  return {{}, std::move(text), is_malformed ? ErrorCode::kMalformed : error.code};
}

Result<RequestedFile> ListModels(const ServiceOptions& options) {
  const Result<std::vector<Spawnable>> models = ListSpawnables(options.world_file, options.overrides);
  if (!models.ok()) return FlattenPlace(models.error());
  RequestedFile file;
  for (const Spawnable& model : models.value()) {
    const EntityKind kind = model.type == "position" ? EntityKind::kRobot : EntityKind::kModel;
    file.spawnables.push_back({.name = model.name, .type = model.type, .kind = kind});
  }
  return file;
}

Result<RequestedFile> Read(const ServiceOptions& options, const ControlRequest& request) {
  if (request.command == ControlCommand::kSpawnables) return ListModels(options);
  Result<LoadedWorld> loaded = request.command == ControlCommand::kLoadWorld
                                   ? LoadWorld(request.source, options.overrides)
                                   : LoadSpawnable(options.world_file, request.source, options.overrides);
  if (!loaded.ok()) return FlattenPlace(loaded.error());
  if (const Status status = CheckLibraries(loaded.value().world, options.libraries); !status.ok())
    return status.error();
  return RequestedFile{std::make_shared<const WorldDescription>(std::move(loaded.value().world)), {}};
}

}  // namespace

Result<RequestedFile> ReadRequestedFile(const ServiceOptions& options, const ControlRequest& request) {
  try {
    return Read(options, request);
  } catch (const std::exception& exception) {  // as of a file system that fails, or without memory
    return FailureOf(exception);
  }
}

}  // namespace troupe
