#include "world-service/observers/ros/workcell_moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "ros/messages/rmf.h"
#include "troupe/deterministic_math.h"
#include "troupe/rectangle.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/find_overlap.h"

namespace troupe {
namespace {

constexpr double kReach = 3.0;                             // m, in the plane, of robots and items
constexpr Interval kReachInHeight{-0.5, 2.5};              // m, above the workcell: within a storey
constexpr double kSpotDistances[] = {0.0, 0.6, 1.2, 1.8};  // m, of places on the ground around a workcell
constexpr int kSpotDirections = 8;

bool IsInReach(const Pose& X_WC, const Pose& pose) {
  const double height = pose.z - X_WC.z;
  return (pose.translation() - X_WC.translation()).squaredNorm() <= kReach * kReach && height >= kReachInHeight.min &&
         height <= kReachInHeight.max;
}

double DistanceTo(const Pose& X_WC, const Pose& pose) {
  return (pose.translation() - X_WC.translation()).squaredNorm();
}

// At present: its entity may be a robot, an object or a person.
Pose PoseOf(const Scene& scene, const WorldState& state, const Workcell& workcell) {
  if (!workcell.root) return workcell.X_WN;
  if (const auto robot = scene.robot_of(*workcell.root)) return state.robots[robot->index()].X_WR;
  if (const auto object = scene.object_of(*workcell.root)) return state.objects[object->index()].X_WO;
  if (const auto person = scene.person_of(*workcell.root)) return state.people[person->index()].X_WP;
  return scene.world().model(*workcell.root).X_PM;
}

// The nearest robot of the fleet but `other`.
std::optional<RobotId> FindRobotNear(const WorldDescription& world, const WorldState& state, const Pose& X_WC,
                                     const std::string& fleet, std::optional<RobotId> other) {
  std::optional<RobotId> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const Pose& X_WR = state.robots[i].X_WR;
    if (RobotId(i) == other || !RobotExists(world, RobotId(i)) || !IsInReach(X_WC, X_WR)) continue;
    if (!fleet.empty() && ros::FleetOf(world, RobotId(i)) != fleet) continue;
    if (DistanceTo(X_WC, X_WR) >= least) continue;
    least = DistanceTo(X_WC, X_WR);
    nearest = RobotId(i);
  }
  return nearest;
}

// The robot on which, or in whose gripper, an object is.
std::optional<RobotId> CarrierOf(const Scene& scene, const ObjectState& object) {
  if (object.holder) return scene.world().gripper(*object.holder).robot;
  return object.support ? scene.robot_of(*object.support) : std::nullopt;
}

// Number of the item: the nearest of those that `is_candidate` names, with the name of the order if there is one.
template <typename IsCandidate>
std::optional<std::size_t> FindItem(const WorldDescription& world, const WorldState& state, const Pose& X_WC,
                                    const std::string& name, const IsCandidate& is_candidate) {
  std::optional<std::size_t> found;
  bool has_name = false;
  double least = 0.0;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const ModelDescription& model = world.model(world.objects[i]);
    if (model.removed || state.objects[i].mode == ObjectMode::kMounted || !is_candidate(i)) continue;
    const bool is_named = !name.empty() && model.name.starts_with(name);
    const double distance = DistanceTo(X_WC, state.objects[i].X_WO);
    if (found && (has_name != is_named ? has_name : distance >= least)) continue;
    found = i;
    has_name = is_named;
    least = distance;
  }
  return found;
}

Pose PoseInTree(const WorldDescription& world, ModelId model, ModelId root) {
  Pose X_RM;
  for (; model != root; model = *world.model(model).parent) X_RM = world.model(model).X_PM * X_RM;
  return X_RM;
}

// The middle of the highest block of an entity, in the frame of its root; the root's origin without any block. Joints
// are at 0.
Pose TopOf(const WorldDescription& world, ModelId root) {
  Pose top;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = root.index(); i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (!model.obstacle_return || model.removed || !IsInTree(world, ModelId(i), root)) continue;
    const Pose X_RM = PoseInTree(world, ModelId(i), root);
    for (const Block& block : world.shape(model.shape).blocks) {
      if (X_RM.z + block.z.max <= highest) continue;
      highest = X_RM.z + block.z.max;
      Rectangle box = Rectangle::Nothing();
      for (const Vec2& corner : block.outline) box.Extend(corner);
      const Vec2 middle = Transform2(X_RM) * box.center();
      top = {middle.x(), middle.y(), highest, 0.0};
    }
  }
  return top;
}

// The item with its lowest point at the height of the pose, if there is room.
Result<ItemMove> MoveTo(const std::shared_ptr<const Scene>& scene, const WorldState& state, std::size_t item,
                        Pose X_WO) {
  const ModelId root = scene->world().objects[item];
  ItemMove move{scene->world().model(root).name, X_WO};
  // The origin of an item need not be at its bottom.
  move.X_WO.z -= LowestPoint(*scene, state, root) - state.objects[item].X_WO.z;
  const Result<EditedWorld> edited = SetPose(scene, state, move.item, move.X_WO);
  if (!edited.ok()) return edited.error();
  return move;
}

// On top of the workcell's entity, or on the ground at its place, or beside that.
Result<ItemMove> MoveInto(const std::shared_ptr<const Scene>& scene, const WorldState& state, const Workcell& workcell,
                          const Pose& X_WC, std::size_t item) {
  if (workcell.root) return MoveTo(scene, state, item, X_WC * TopOf(scene->world(), *workcell.root));
  Error refused;
  for (const double distance : kSpotDistances) {
    for (int i = 0; i < (distance > 0.0 ? kSpotDirections : 1); ++i) {
      const double angle = 2.0 * kPi * i / kSpotDirections;
      Pose spot = X_WC * Pose{0.0, 0.0, 0.0, WrapAngle(angle)} * Pose{distance, 0.0, 0.0, 0.0};
      spot.heading = X_WC.heading;
      Result<ItemMove> move = MoveTo(scene, state, item, spot);
      if (move.ok()) return move;
      refused = move.error();
    }
  }
  return refused;
}

}  // namespace

std::vector<Workcell> FindWorkcells(const WorldDescription& world) {
  std::vector<Workcell> workcells;
  const auto add = [&](const NamedPlace& place, const std::string& prefix, WorkcellKind kind) {
    const std::optional<std::string> name = ros::TagAfter(place, prefix);
    if (!name) return;
    const auto known = std::find_if(workcells.begin(), workcells.end(),
                                    [&](const Workcell& each) { return each.name == *name && each.kind == kind; });
    if (known != workcells.end()) {
      if (place.name == *name) known->X_WN = place.X_WN;
      return;
    }
    Workcell workcell{*name, kind, place.X_WN};
    if (const Result<ModelId> root = FindEntity(world, *name); root.ok()) workcell.root = root.value();
    workcells.push_back(std::move(workcell));
  };
  for (const NamedPlace& place : world.places) {
    add(place, "dispenser:", WorkcellKind::kDispenser);
    add(place, "ingestor:", WorkcellKind::kIngestor);
  }
  return workcells;
}

Result<ItemMove> PlanMove(const std::shared_ptr<const Scene>& scene, const WorldState& state, const Workcell& workcell,
                          const WorkcellOrder& order, const std::set<std::string>& moving) {
  const WorldDescription& world = scene->world();
  const Pose X_WC = PoseOf(*scene, state, workcell);
  const std::optional<RobotId> body = workcell.root ? scene->robot_of(*workcell.root) : std::nullopt;
  const std::optional<RobotId> robot = FindRobotNear(world, state, X_WC, order.fleet, body);
  if (!robot) {
    return Error{
        {},
        fmt::format("no robot{} is within {} m", order.fleet.empty() ? "" : " of fleet '" + order.fleet + "'", kReach)};
  }
  const bool dispenses = workcell.kind == WorkcellKind::kDispenser;
  const auto is_candidate = [&](std::size_t i) {
    if (world.objects[i] == workcell.root || moving.contains(world.model(world.objects[i]).name)) return false;
    const std::optional<RobotId> carrier = CarrierOf(*scene, state.objects[i]);
    if (!dispenses) return carrier == robot;
    return (!carrier || carrier == body) && IsInReach(X_WC, state.objects[i].X_WO);
  };
  const std::optional<std::size_t> item = FindItem(world, state, X_WC, order.item, is_candidate);
  const std::string& name = world.robot(*robot).name;
  if (!item) {
    return Error{{},
                 dispenses ? fmt::format("no item for robot '{}' is within {} m", name, kReach)
                           : fmt::format("robot '{}' carries no item", name)};
  }
  if (!dispenses) return MoveInto(scene, state, workcell, X_WC, *item);
  const Pose& X_WR = state.robots[robot->index()].X_WR;
  return MoveTo(scene, state, *item, X_WR * TopOf(world, world.robot(*robot).root));
}

}  // namespace troupe
