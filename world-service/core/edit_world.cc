#include "world-service/core/edit_world.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/limits.h"
#include "common/model/device_limits.h"
#include "common/spatial/convex_piece.h"
#include "world-service/core/find_overlap.h"
#include "world-service/core/step.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxNameLength = 1000;  // bytes, as of names in world files

Status CheckPose(const Pose& pose) {
  for (const double number : {pose.x, pose.y, pose.z, pose.heading}) {
    if (!std::isfinite(number)) return BadInput("found a pose that is not finite");
    if (std::abs(number) > kMaxMagnitude) return BadInput("found a pose beyond 1e6, expected one in the world");
  }
  return Status();
}

void Fall(ObjectState& object) {
  object.mode = ObjectMode::kFalling;
  object.fall_speed = 0.0;
  object.holder = std::nullopt;
  object.support = std::nullopt;
}

// Ends all holds of and on the tree of `root`; the objects that rest on it fall.
// Every edit of an entity begins here: from then on nothing refers to the tree, so that it can be moved or removed.
void Detach(StepWorkspace& workspace, ModelId root) {
  const WorldDescription& world = workspace.world();
  const std::optional<ObjectId> object = workspace.scene.object_of(root);
  const auto in_tree = [&](const std::optional<ModelId>& model) { return model && IsInTree(world, *model, root); };
  // Others that only wait for the object forget it first, so that none of them holds it from then on.
  std::vector<GripperId> holding;
  for (std::size_t i = 0; i < workspace.next.grippers.size(); ++i) {
    GripperState& gripper = workspace.next.grippers[i];
    if (object && workspace.next.objects[object->index()].holder == GripperId(i)) {
      holding.push_back(GripperId(i));
      continue;
    }
    if (object && gripper.clamped == object) gripper = {};
    if (in_tree(gripper.left_contact)) gripper.left_contact = std::nullopt;
    if (in_tree(gripper.right_contact)) gripper.right_contact = std::nullopt;
  }
  // Release would hand the object over to another gripper that has it between its pads; such grippers have forgotten it
  // above.
  for (const GripperId gripper : holding) Release(workspace, gripper);
  if (const std::optional<RobotId> robot = workspace.scene.robot_of(root)) {
    for (const GripperId gripper : workspace.scene.grippers_of(*robot)) {
      Release(workspace, gripper);
      workspace.next.grippers[gripper.index()] = {};
    }
    workspace.next.robots[robot->index()].twist = {};
    workspace.next.robots[robot->index()].stalled = false;
  }
  if (const std::optional<PersonId> person = workspace.scene.person_of(root)) {
    PersonState& state = workspace.next.people[person->index()];
    state.vx = state.vy = 0.0;
    state.door = 0;
    state.EndRide();
  }
  for (std::size_t i = 0; i < workspace.next.objects.size(); ++i) {
    ObjectState& other = workspace.next.objects[i];
    if (other.mode == ObjectMode::kMounted) continue;
    // What rested on the tree, and what its grippers have let go of, falls in the next tick, or finds its support at
    // once.
    if (in_tree(other.support) || (workspace.needs_support[i] != 0 && !other.holder)) Fall(other);
  }
}

EditedWorld Finish(StepWorkspace& workspace, std::shared_ptr<const Scene> scene) {
  return {std::move(scene), std::move(workspace.next), std::move(workspace.robot_events)};
}

// A world file may place a model below the ground, where nothing supports it; an edit may not.
Status CheckAboveGround(const EditedWorld& edited, ModelId root, const Pose& X_WE) {
  // An entity at or above the ground may have blocks below its origin; only a pose below the ground is an error of the
  // user.
  if (X_WE.z >= 0.0) return {};
  const double lowest = LowestPoint(*edited.scene, edited.state, root);
  if (lowest >= -kNoticeableDepth) return {};
  std::ostringstream reason;
  reason << "'" << edited.scene->world().model(root).name << "' would be " << -lowest
         << " m below the ground, expected z of at least " << std::min(0.0, X_WE.z - lowest);
  return BadInput(reason.str());
}

// Marks an error of a place that is taken.
Status WithoutRoom(Status problem) {
  if (problem.ok()) return problem;
  Error error = problem.error();
  error.code = ErrorCode::kNoRoom;
  return error;
}

// The error names the ground, or the obstacle that the entity overlaps.
Status CheckRoom(const EditedWorld& edited, ModelId root, const Pose& X_WE) {
  if (Status below = WithoutRoom(CheckAboveGround(edited, root, X_WE)); !below.ok()) return below;
  const std::optional<ModelId> obstacle = FindOverlap(*edited.scene, edited.state, root);
  if (!obstacle) return {};
  const WorldDescription& world = edited.scene->world();
  return WithoutRoom(
      BadInput("'" + world.model(root).name + "' would be inside '" + world.model(*obstacle).name + "'"));
}

// Removes the tree of `root` from the description.
// The models stay, because ids are indices, but have no body: all of them share one empty shape.
void Remove(WorldDescription& world, ModelId root) {
  auto empty = std::find(world.shapes.begin(), world.shapes.end(), Shape{});
  if (empty == world.shapes.end()) empty = world.shapes.insert(world.shapes.end(), Shape{});
  const ShapeId no_body(static_cast<std::size_t>(empty - world.shapes.begin()));
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    if (!IsInTree(world, ModelId(i), root)) continue;
    world.models[i].removed = true;
    world.models[i].shape = no_body;
  }
}

// Of a robot that is where its plan does not have it: it begins anew, at the vertex that is nearest then.
void LeaveTraffic(WorldState& state, RobotId robot) {
  std::erase_if(state.traffic_robots, [&](const TrafficRobot& row) { return row.robot == robot; });
  std::erase_if(state.charging_robots, [&](const ChargingRobot& row) { return row.robot == robot; });
  std::erase_if(state.traffic_moves, [&](const TrafficMove& move) { return move.robot == robot; });
}

// A removed entity stays where it was last, at rest.
void RemoveFromState(const Scene& scene, WorldState& state, ModelId root) {
  if (const std::optional<RobotId> robot = scene.robot_of(root)) {
    for (const JointId joint : scene.joints_of(*robot)) {
      state.joints[joint.index()].velocity = 0.0;
      state.joints[joint.index()].blocked = false;
    }
    // A removed robot stands still: its units keep no old velocity, which would be a part of the state's hash.
    KeepVelocities(scene, *robot, state);
    LeaveTraffic(state, *robot);
    // Radio messages from and to a removed robot are lost.
    std::erase_if(state.transmissions, [&](const RadioTransmission& transmission) {
      return transmission.from == *robot || transmission.message.to == *robot;
    });
  }
  if (const std::optional<ObjectId> object = scene.object_of(root)) {
    const Pose X_WO = state.objects[object->index()].X_WO;
    state.objects[object->index()] = {};
    state.objects[object->index()].X_WO = X_WO;
  }
}

bool IsNameFree(const WorldDescription& world, const std::string& name) {
  return std::none_of(world.models.begin(), world.models.end(),
                      [&](const ModelDescription& model) { return !model.removed && model.name == name; });
}

// Equal shapes are one, as loaders make them: a hundred spawned robots have one body in memory.
ShapeId AddShape(WorldDescription& world, const Shape& shape) {
  const auto same = std::find(world.shapes.begin(), world.shapes.end(), shape);
  const ShapeId id(static_cast<std::size_t>(same - world.shapes.begin()));
  if (same == world.shapes.end()) world.shapes.push_back(shape);
  return id;
}

// Appends all of `spawned`, whose only entity is its first model.
void Append(WorldDescription& world, const WorldDescription& spawned, const std::string& name, const Pose& X_WE) {
  const std::string old_name = spawned.models.front().name;
  const auto model_id = [first = world.models.size()](ModelId id) { return ModelId(first + id.index()); };
  const auto robot_id = [first = world.robots.size()](RobotId id) { return RobotId(first + id.index()); };
  const auto joint_id = [first = world.joints.size()](JointId id) { return JointId(first + id.index()); };
  for (ModelDescription model : spawned.models) {
    if (model.parent) {
      model.parent = model_id(*model.parent);
      // The names of children begin with that of their parent.
      if (model.name.starts_with(old_name + ".")) model.name.replace(0, old_name.size(), name);
    } else {
      model.X_PM = X_WE;
      model.name = name;
    }
    model.shape = AddShape(world, spawned.shape(model.shape));
    world.models.push_back(std::move(model));
  }
  for (RobotDescription robot : spawned.robots) {
    robot.name = name;
    robot.root = model_id(robot.root);
    for (SensorDescription& sensor : robot.sensors) sensor.model = model_id(sensor.model);
    for (MountedFrame& frame : robot.frames) frame.model = model_id(frame.model);
    world.robots.push_back(std::move(robot));
  }
  for (JointDescription joint : spawned.joints) {
    joint.robot = robot_id(joint.robot);
    joint.model = model_id(joint.model);
    world.joints.push_back(std::move(joint));
  }
  for (GripperDescription gripper : spawned.grippers) {
    gripper.robot = robot_id(gripper.robot);
    gripper.model = model_id(gripper.model);
    gripper.left = joint_id(gripper.left);
    gripper.right = joint_id(gripper.right);
    gripper.left_pad = model_id(gripper.left_pad);
    gripper.right_pad = model_id(gripper.right_pad);
    if (gripper.lift) gripper.lift = joint_id(*gripper.lift);
    world.grippers.push_back(std::move(gripper));
  }
  for (const ModelId object : spawned.objects) world.objects.push_back(model_id(object));
}

// Adds the initial states of the robots, joints, grippers and objects that `state` has not.
// Objects begin as falling: where one is spawned on a support, the next tick finds it without a motion.
void AppendState(const WorldDescription& world, WorldState& state) {
  const WorldState initial = PlacedState(world);
  const auto append = [](const auto& from, auto& to) {
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(to.size()), from.end());
  };
  const std::size_t objects = state.objects.size();
  append(initial.robots, state.robots);
  append(initial.joints, state.joints);
  append(initial.grippers, state.grippers);
  append(initial.objects, state.objects);
  append(initial.stores, state.stores);
  append(initial.imus, state.imus);
  append(initial.lights, state.lights);
  append(initial.cameras, state.cameras);
  append(initial.doors, state.doors);
  append(initial.lifts, state.lifts);
  append(initial.people, state.people);
  for (std::size_t i = objects; i < state.objects.size(); ++i) Fall(state.objects[i]);
}

}  // namespace

Result<ModelId> FindEntity(const WorldDescription& world, const std::string& name) {
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.removed || model.name != name) continue;
    if (!model.parent) return ModelId(i);
    return BadInput("'" + name + "' is a part of '" + world.model(*model.parent).name + "', expected a whole entity");
  }
  std::vector<std::string> names;
  for (const ModelDescription& model : world.models) {
    if (!model.removed && !model.parent) names.push_back(model.name);
  }
  return BadInput("the world has no entity '" + name + "'" + DidYouMean(name, names));
}

Result<EditedWorld> SetPose(const std::shared_ptr<const Scene>& scene, const WorldState& state, const std::string& name,
                            const Pose& X_WE) {
  const Result<ModelId> root = FindEntity(scene->world(), name);
  if (!root.ok()) return root.error();
  if (const Status fixed = CheckIsMovable(scene->world(), root.value()); !fixed.ok()) return fixed.error();
  if (const Status valid = CheckPose(X_WE); !valid.ok()) return valid.error();
  Pose pose = X_WE;
  pose.heading = WrapAngle(pose.heading);
  StepMemory memory(*scene, state);
  StepWorkspace workspace(*scene, memory);
  Detach(workspace, root.value());
  std::shared_ptr<const Scene> after = scene;
  if (const std::optional<RobotId> robot = scene->robot_of(root.value())) {
    workspace.next.robots[robot->index()].X_WR = pose;
    // A jump is no acceleration for the robot's units.
    KeepVelocities(*scene, *robot, workspace.next);
    LeaveTraffic(workspace.next, *robot);
  } else if (const std::optional<ObjectId> object = scene->object_of(root.value())) {
    Fall(workspace.next.objects[object->index()]);
    workspace.next.objects[object->index()].X_WO = pose;
  } else if (const std::optional<PersonId> person = scene->person_of(root.value())) {
    workspace.next.people[person->index()].X_WP = pose;
  } else {
    // A static model is a part of the static index: the whole scene is made again, with a copy of the description.
    WorldDescription world = scene->world();
    world.models[root.value().index()].X_PM = pose;
    after = std::make_shared<const Scene>(std::move(world));
  }
  // The check comes last, on the finished world: the room is that which the entity would have there, without what it
  // has let go of. On an error the edited world is dropped.
  EditedWorld edited = Finish(workspace, std::move(after));
  if (const Status problem = CheckRoom(edited, root.value(), pose); !problem.ok()) return problem.error();
  return edited;
}

Result<EditedWorld> DeleteEntity(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                                 const std::string& name) {
  const Result<ModelId> root = FindEntity(scene->world(), name);
  if (!root.ok()) return root.error();
  if (const Status fixed = CheckIsMovable(scene->world(), root.value()); !fixed.ok()) return fixed.error();
  StepMemory memory(*scene, state);
  StepWorkspace workspace(*scene, memory);
  Detach(workspace, root.value());
  RemoveFromState(*scene, workspace.next, root.value());
  WorldDescription world = scene->world();
  Remove(world, root.value());
  return Finish(workspace, std::make_shared<const Scene>(std::move(world)));
}

WorldDescription ExtractEntity(const WorldDescription& world, ModelId root) {
  WorldDescription entity;
  entity.name = world.name;
  entity.seed = world.seed;
  entity.interval_ns = world.interval_ns;
  entity.gravity = world.gravity;
  // Ordered maps, as all in this folder: no iteration depends on addresses or hashes.
  std::map<ModelId, ModelId> models;  // from the world to the entity
  // Children have greater ids than their parents, so that each parent has been copied before.
  for (std::size_t i = root.index(); i < world.models.size(); ++i) {
    if (!IsInTree(world, ModelId(i), root)) continue;
    models[ModelId(i)] = ModelId(entity.models.size());
    ModelDescription model = world.models[i];
    if (model.parent) model.parent = models.at(*model.parent);
    model.shape = AddShape(entity, world.shape(model.shape));
    entity.models.push_back(std::move(model));
  }
  std::map<JointId, JointId> joints;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (world.robots[i].root != root) continue;
    RobotDescription robot = world.robots[i];
    robot.root = models.at(robot.root);
    for (SensorDescription& sensor : robot.sensors) sensor.model = models.at(sensor.model);
    for (MountedFrame& frame : robot.frames) frame.model = models.at(frame.model);
    entity.robots.push_back(std::move(robot));
    for (std::size_t j = 0; j < world.joints.size(); ++j) {
      if (world.joints[j].robot != RobotId(i)) continue;
      joints[JointId(j)] = JointId(entity.joints.size());
      entity.joints.push_back(world.joints[j]);
      entity.joints.back().robot = RobotId(0);
      entity.joints.back().model = models.at(world.joints[j].model);
    }
    for (GripperDescription gripper : world.grippers) {
      if (gripper.robot != RobotId(i)) continue;
      gripper.robot = RobotId(0);
      for (ModelId* model : {&gripper.model, &gripper.left_pad, &gripper.right_pad}) *model = models.at(*model);
      for (JointId* joint : {&gripper.left, &gripper.right}) *joint = joints.at(*joint);
      if (gripper.lift) gripper.lift = joints.at(*gripper.lift);
      entity.grippers.push_back(std::move(gripper));
    }
  }
  for (const ModelId object : world.objects) {
    if (object == root) entity.objects.push_back(models.at(object));
  }
  return entity;
}

std::string FreeName(const WorldDescription& world, const std::string& base) {
  // Names of all models count, not only of roots: a request or an event may name a child, too.
  std::set<std::string> names;
  for (const ModelDescription& model : world.models) {
    if (!model.removed) names.insert(model.name);
  }
  if (!names.contains(base)) return base;
  for (std::size_t number = 0;; ++number) {
    std::string name = base + std::to_string(number);
    if (!names.contains(name)) return name;
  }
}

std::string NameOfSource(const std::string& source) {
  const std::size_t hash = source.rfind('#');
  if (hash != std::string::npos) return source.substr(hash + 1);
  return std::filesystem::path(source).stem().string();
}

Result<EditedWorld> SpawnEntity(const std::shared_ptr<const Scene>& scene, const WorldState& state,
                                const WorldDescription& spawned, const std::string& name, const Pose& X_WE) {
  const auto entities = std::count_if(spawned.models.begin(), spawned.models.end(),
                                      [](const ModelDescription& model) { return !model.parent; });
  if (entities != 1) {
    return BadInput("found " + std::to_string(entities) + " models to spawn, expected one, with its parts");
  }
  if (name.empty()) return BadInput("found no name, expected one");
  if (name.size() > kMaxNameLength) {
    return BadInput("found a name of " + std::to_string(name.size()) + " bytes, expected at most " +
                    std::to_string(kMaxNameLength));
  }
  if (const Status valid = CheckPose(X_WE); !valid.ok()) return valid.error();
  Pose pose = X_WE;
  pose.heading = WrapAngle(pose.heading);
  WorldDescription world = scene->world();
  const ModelId root(world.models.size());
  Append(world, spawned, name, pose);
  for (std::size_t i = root.index(); i < world.models.size(); ++i) {
    // Of the children, too: "cart.wheel" may exist although "cart" does not.
    if (!IsNameFree(scene->world(), world.models[i].name)) {
      return BadInput("the name '" + world.models[i].name + "' is in use");
    }
  }
  // The spawned world comes from a user's file: for instance two robots may want one ROS domain.
  if (const Status problem = Validate(world); !problem.ok()) return problem.error();
  EditedWorld edited;
  edited.state = state;
  AppendState(world, edited.state);
  edited.scene = std::make_shared<const Scene>(std::move(world));
  if (const Status problem = CheckRoom(edited, root, pose); !problem.ok()) return problem.error();
  return edited;
}

EditedWorld ResetWorld(const std::shared_ptr<const Scene>& original, const std::shared_ptr<const Scene>& scene,
                       const WorldState& state, const ResetScopes& scopes) {
  if (scopes.time && scopes.state && scopes.spawned && scopes.deleted) {
    // Exactly the start of the run, with the ids of the world as loaded.
    return {original, InitialState(*original), {}, true};
  }
  EditedWorld edited{scene, state, {}, scopes.time || scopes.state};
  const std::vector<ModelDescription>& loaded = original->world().models;
  if (scopes.spawned) {
    for (std::size_t i = loaded.size(); i < scene->world().models.size(); ++i) {
      const ModelDescription& model = edited.scene->world().models[i];
      if (model.parent || model.removed) continue;
      // Cannot fail: a spawned entity exists, and doors and lifts, which are not movable, are never spawned.
      Result<EditedWorld> without = DeleteEntity(edited.scene, edited.state, model.name);
      edited.scene = without.value().scene;
      edited.state = without.value().state;
      std::move(without.value().events.begin(), without.value().events.end(), std::back_inserter(edited.events));
    }
  }
  if (scopes.state) {
    WorldDescription world = edited.scene->world();
    // Static models that were moved go back; joints, objects and robots follow from InitialState.
    for (std::size_t i = 0; i < loaded.size(); ++i) world.models[i].X_PM = loaded[i].X_PM;
    if (!(world == edited.scene->world())) edited.scene = std::make_shared<const Scene>(std::move(world));
    edited.events.clear();
    edited.state = InitialState(*edited.scene);
    edited.state.tick = state.tick;
  }
  if (scopes.time) {
    edited.state.tick = 0;
    // Their ticks would be in the future.
    edited.state.transmissions.clear();
    edited.state.lane_closures.clear();
    for (TrafficRobot& robot : edited.state.traffic_robots) robot.since = 0;
    for (ChargingRobot& robot : edited.state.charging_robots) robot.since = 0;
    for (Job& job : edited.state.jobs) {
      job.due -= job.since;
      job.since = 0;
    }
    for (RobotWait& wait : edited.state.waits) wait.since = 0;
  }
  return edited;
}

}  // namespace troupe
