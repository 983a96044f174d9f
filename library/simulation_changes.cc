// Changes of a simulation from outside, by the functions with which the world service executes those of its tools.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/model/proposal.h"
#include "common/spatial/check_order.h"
#include "library/simulation_content.h"
#include "robot-agent/controller/create_controller.h"
#include "troupe/simulation.h"
#include "world-service/core/edit_world.h"
#include "worldfile/load_world.h"

namespace troupe {

Status Simulation::SendTo(RobotId robot, Goal goal) {
  Snapshot::Content& now = impl_->now;
  if (Status problem = CheckRobotCommand(world(), {.robot = robot, .goal = goal}); !problem.ok()) return problem;
  const RobotDescription& description = world().robot(robot);
  if (!now.robots[robot.index()]->accepts_goals()) {
    return BadInput(
        fmt::format("the controller of '{}' ({}) accepts no goals", description.name, description.controller.name));
  }
  if (Status reason = CheckGoalOfController(*now.scene, robot, pose(robot), goal); !reason.ok()) {
    return BadInput(fmt::format("'{}' cannot reach the goal: {}", description.name, reason.error().message));
  }
  goal.number = ++now.goals;
  now.commands[robot.index()].goal = std::move(goal);
  return {};
}

void Simulation::CancelGoal(RobotId robot) {
  impl_->now.commands[robot.index()].goal.reset();
}

Status Simulation::SendMessage(RobotId robot, FleetMessage message) {
  std::vector<FleetMessage>& messages = impl_->now.commands[robot.index()].fleet;
  RobotCommand command{.robot = robot, .messages = messages};
  command.messages.push_back(std::move(message));
  if (Status problem = CheckRobotCommand(world(), command); !problem.ok()) return problem;
  messages = std::move(command.messages);
  return {};
}

Status Simulation::AddInput(const Input& input) {
  if (Status problem = CheckInput(*impl_->now.scene, input); !problem.ok()) return problem;
  impl_->now.inputs.push_back(input);
  return {};
}

Result<Pose> Simulation::FindPose(const std::string& entity) const {
  const Result<ModelId> model = FindEntity(world(), entity);
  if (!model.ok()) return model.error();
  return ModelPoses(world(), state())[model.value().index()];
}

Status Simulation::SetPose(const std::string& entity, const Pose& X_WE) {
  return Follow(troupe::SetPose(impl_->now.scene, state(), entity, X_WE));
}

Status Simulation::Delete(const std::string& entity) {
  return Follow(DeleteEntity(impl_->now.scene, state(), entity));
}

Result<std::string> Simulation::Spawn(const std::string& source, const Pose& X_WE, const std::string& name,
                                      const std::optional<ControllerDescription>& controller) {
  const Snapshot::Content& now = impl_->now;
  const SimulationOrigin& origin = *now.origin;
  LoadOverrides overrides;
  overrides.seed = world().seed;
  overrides.controller = origin.controller;
  if (origin.runs_controllers) overrides.check_controller = CheckController;
  Result<LoadedWorld> loaded = LoadSpawnable(origin.world, source, overrides);
  if (!loaded.ok()) return loaded.error();
  WorldDescription& spawned = loaded.value().world;
  if (controller) {
    if (Status problem = SetController(*controller, overrides, spawned); !problem.ok()) return problem.error();
  }
  if (!origin.runs_controllers) {
    for (RobotDescription& robot : spawned.robots) robot.controller = {};
  }
  std::string found = name.empty() ? FreeName(world(), NameOfSource(source)) : name;
  if (Status problem = Follow(SpawnEntity(now.scene, state(), spawned, found, X_WE)); !problem.ok()) {
    return problem.error();
  }
  return found;
}

Status Simulation::Follow(Result<EditedWorld> edited) {
  if (!edited.ok()) return edited.error();
  Snapshot::Content& now = impl_->now;
  const std::shared_ptr<const Scene>& scene = edited.value().scene;
  // What can fail comes first.
  std::vector<std::unique_ptr<Robot>> added;
  for (std::size_t i = now.robots.size(); i < scene->world().robots.size(); ++i) {
    Result<std::unique_ptr<Robot>> robot = Robot::Create(*scene, RobotId(i), {nullptr, AllowedPaths::All()});
    if (!robot.ok()) return robot.error();
    added.push_back(std::move(robot).value());
  }
  // Odometry counts the motion up to this tick, and the jump of the edit not as one.
  for (const std::unique_ptr<Robot>& robot : now.robots) robot->UpdateOdometry(state());
  if (scene != now.scene) {
    for (const std::unique_ptr<Robot>& robot : now.robots) robot->ChangeWorld(*scene);
    impl_->bodies = BodyIndex(*scene);
    now.scene = scene;
  }
  if (!added.empty()) now.robot_scenes.push_back(scene);
  std::move(added.begin(), added.end(), std::back_inserter(now.robots));
  now.commands.resize(now.robots.size());
  now.state = std::make_shared<const WorldState>(std::move(edited.value().state));
  now.events.insert(now.events.end(), std::make_move_iterator(edited.value().events.begin()),
                    std::make_move_iterator(edited.value().events.end()));
  for (const std::unique_ptr<Robot>& robot : now.robots) robot->Relocate(*now.state);
  impl_->bodies.Assign(*now.state);
  return {};
}

}  // namespace troupe
