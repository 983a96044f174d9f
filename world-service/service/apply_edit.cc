#include "world-service/service/apply_edit.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "world-service/core/initial_state.h"

namespace troupe {
namespace {

Result<EditedWorld> Reset(std::uint8_t scopes, const std::shared_ptr<const Scene>& original,
                          const std::shared_ptr<const Scene>& scene, const WorldState& state) {
  constexpr std::uint8_t kKnown = kResetTime | kResetState | kResetSpawned;
  if (scopes == kResetAll) return ResetWorld(original, scene, state, {});
  if (scopes == 0 || (scopes & ~kKnown) != 0) {
    return Error{{}, "found the scopes " + std::to_string(scopes) + ", expected 1 to 7, or 255"};
  }
  return ResetWorld(original, scene, state,
                    {.time = (scopes & kResetTime) != 0,
                     .state = (scopes & kResetState) != 0,
                     .spawned = (scopes & kResetSpawned) != 0,
                     .deleted = false});
}

EditedWorld Load(const WorldDescription& world) {
  EditedWorld loaded;
  loaded.scene = std::make_shared<const Scene>(world);
  loaded.state = InitialState(*loaded.scene);
  loaded.fresh = true;
  return loaded;
}

}  // namespace

bool IsEdit(ControlCommand command) {
  switch (command) {
    case ControlCommand::kReset:
    case ControlCommand::kLoadWorld:
    case ControlCommand::kSpawn:
    case ControlCommand::kDelete:
    case ControlCommand::kSetPose:
    case ControlCommand::kRewind:
    case ControlCommand::kChange:
    case ControlCommand::kSetTwist:
      return true;
    case ControlCommand::kStatus:
    case ControlCommand::kPause:
    case ControlCommand::kPlay:
    case ControlCommand::kStep:
    case ControlCommand::kEntities:
    case ControlCommand::kSpawnables:
    case ControlCommand::kSpeed:
    case ControlCommand::kCommandRobot:
    case ControlCommand::kRestore:  // becomes a spawn
    case ControlCommand::kWorld:
    case ControlCommand::kWorlds:
      return false;
  }
  return false;
}

Result<EditedWorld> ApplyEdit(const AppliedEdit& edit, const std::shared_ptr<const Scene>& original,
                              const std::shared_ptr<const Scene>& scene, const WorldState& state) {
  const ControlRequest& request = edit.request;
  switch (request.command) {
    case ControlCommand::kReset:
      return Reset(request.scopes, original, scene, state);
    case ControlCommand::kSetPose:
      return SetPose(scene, state, request.name, request.pose);
    case ControlCommand::kSetTwist:
      return SetTwist(scene, state, request.name, request.twist);
    case ControlCommand::kDelete:
      return DeleteEntity(scene, state, request.name);
    case ControlCommand::kSpawn:
      if (edit.world == nullptr) return Error{{}, "found nothing to spawn"};
      return SpawnEntity(scene, state, *edit.world, request.name, request.pose);
    case ControlCommand::kLoadWorld:
      if (edit.world == nullptr) return Error{{}, "found no world"};
      return Load(*edit.world);
    case ControlCommand::kChange: {
      const Result<WorldChanges> changes = WorldChanges::FromText(request.source);
      if (!changes.ok()) return changes.error();
      return EditedWorld{std::make_shared<const Scene>(changes.value().AppliedTo(scene->world())), state, {}, false};
    }
    case ControlCommand::kRewind: {
      if (edit.world == nullptr || edit.restored == nullptr) return Error{{}, "found no state to restore"};
      return EditedWorld{std::make_shared<const Scene>(*edit.world), *edit.restored, {}, true};
    }
    default:
      return Error{{}, "found no edit"};
  }
}

using Json = nlohmann::json;

WorldDescription WorldChanges::AppliedTo(WorldDescription world) const {
  if (seed) world.seed = *seed;
  for (RobotDescription& robot : world.robots) {
    const auto changed = controllers.find(robot.name);
    if (changed != controllers.end()) robot.controller = changed->second;
  }
  return world;
}

std::string WorldChanges::ToText() const {
  Json text = Json::object();
  if (seed) text["seed"] = *seed;
  for (const auto& [robot, controller] : controllers) {
    text["controllers"][robot] = {{"name", controller.name}, {"parameters", controller.parameters}};
  }
  return text.dump();
}

Result<WorldChanges> WorldChanges::FromText(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  const Error malformed{{}, "found changes that are not a JSON object with a seed and controllers"};
  if (!json.is_object()) return malformed;
  WorldChanges changes;
  for (const auto& [key, value] : json.items()) {
    if (key == "seed" && value.is_number_unsigned()) {
      changes.seed = value.get<std::uint64_t>();
    } else if (key == "controllers" && value.is_object()) {
      for (const auto& [robot, controller] : value.items()) {
        if (!controller.is_object() || !controller.contains("name") || !controller["name"].is_string() ||
            !controller.contains("parameters") || !controller["parameters"].is_string()) {
          return malformed;
        }
        changes.controllers[robot] = {controller["name"].get<std::string>(),
                                      controller["parameters"].get<std::string>()};
      }
    } else {
      return malformed;
    }
  }
  return changes;
}

}  // namespace troupe
