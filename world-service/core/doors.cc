// Doors (step_workspace.h: MoveDoors), and the rule which entities of a building an edit may move.
//
// A door has one opening for all of its leaves: the first contact of any leaf stops them all. Only robots, objects and
// people stop a leaf. Static models do not: a sliding leaf disappears in its wall, and the leaf of a turning door
// begins at its frame. Leaves and cabins do not stop each other, either.
//
// A door moves after all robots of the tick and before people, so that a robot in the doorway always wins: the door
// waits with `blocked` set and tries again in each tick, without a force on the robot.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/model/states.h"
#include "common/spatial/convex_piece.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// One door in one tick.
class DoorTurn {
 public:
  // `is_asked_for`: by a person; nothing in a world without people.
  DoorTurn(StepWorkspace& workspace, std::size_t number, std::optional<bool> is_asked_for)
      : workspace_(workspace),
        door_(workspace.world().doors[number]),
        state_(workspace.next.doors[number]),
        is_asked_for_(is_asked_for) {}

  void Act() {
    // Else nothing opens the door but its target, and `held` stays as it is: false, or as its lift has set it.
    if (door_.detection_radius > 0.0 || door_.sensor_depth > 0.0 || door_.reopens || is_asked_for_) {
      const bool is_sensed = is_asked_for_.value_or(false) || (door_.detection_radius > 0.0 && HasRobotInReach()) ||
                             (door_.sensor_depth > 0.0 && HasBodyAtSensor());
      state_.held = IsHeld(is_sensed);
    }
    state_.blocked = false;
    const double way = state_.commanded_opening() - state_.opening;
    if (way == 0.0) return;
    const double most = workspace_.seconds() / door_.seconds;
    // At the end of its way the opening is exactly the commanded one, never a sum of steps: a lift departs when its
    // doors are at 0, people enter at 1, and the events compare for equality.
    const double end = std::fabs(way) <= most ? state_.commanded_opening() : state_.opening + std::copysign(most, way);
    const double rate = std::copysign(1.0 / door_.seconds, way);
    const double duration = std::fabs(end - state_.opening) * door_.seconds;
    // A time since the start of the tick, in s.
    const std::optional<double> contact = FirstContactOfLeaves(rate, duration);
    // Clamped against rounding of the product.
    const double opening = contact ? std::clamp(state_.opening + rate * *contact, 0.0, 1.0) : end;
    state_.blocked = contact.has_value();
    if (opening != state_.opening) MoveTo(opening);
  }

 private:
  // The hold time begins when nothing is at the door any more, and counts while it is open, or cannot open further. The
  // edge that reopens is a hold, too: from the contact until it is open.
  bool IsHeld(bool is_sensed) {
    const auto hold = static_cast<std::uint32_t>(TicksIn(workspace_.world(), door_.hold));
    if (is_sensed) {
      state_.hold_ticks = hold;
      return true;
    }
    const bool was_closing = !state_.held && state_.target < state_.opening;
    if (door_.reopens && state_.blocked && was_closing) state_.hold_ticks = std::max<std::uint32_t>(hold, 1);
    if (state_.hold_ticks == 0) return false;
    if (state_.opening == 1.0 || (state_.held && state_.blocked)) --state_.hold_ticks;
    return true;
  }

  // A robot or a person on the level of the door whose origin is in the region of its sensor.
  bool HasBodyAtSensor() const {
    const Pose& X_WD = workspace_.scene.X_LM(door_.model);
    const ZRange heights = Heights();
    const double half_width = 0.5 * door_.sensor_width;
    const double radius = std::sqrt(half_width * half_width + door_.sensor_depth * door_.sensor_depth);
    bool found = false;
    workspace_.bodies.ForEachNear(Rectangle::Around(X_WD.translation(), radius), [&](BodyId id) {
      if (found || !IsRobotOrPerson(id)) return;
      const Pose& X_WB = workspace_.bodies.X_WB(id);
      const Vec2 p_D = Transform2(X_WD).InverseTransform(X_WB.translation());
      found = std::fabs(p_D.x()) <= half_width && std::fabs(p_D.y()) <= door_.sensor_depth &&
              heights.Overlaps(workspace_.scene.body(id).z + X_WB.z);
    });
    return found;
  }

  bool IsRobotOrPerson(BodyId id) const {
    const WorldDescription& world = workspace_.world();
    if (id.index() < workspace_.next.robots.size()) return RobotExists(world, RobotId(id.index()));
    const std::optional<PersonId> person = workspace_.scene.person_of(id);
    return person && !world.model(world.person(*person).root).removed;
  }

  // A robot on the level of the door whose origin is within its reach.
  bool HasRobotInReach() const {
    // The model of a door never moves, so that its pose on its link is that in W.
    const Vec2 middle = workspace_.scene.X_LM(door_.model).translation();
    const ZRange heights = Heights();
    bool found = false;
    workspace_.bodies.ForEachNear(Rectangle::Around(middle, door_.detection_radius), [&](BodyId id) {
      // Bodies of robots come first. Doors open for robots by themselves; people ask for them.
      if (found || id.index() >= workspace_.next.robots.size()) return;
      const Pose& X_WR = workspace_.bodies.X_WB(id);
      found = (X_WR.translation() - middle).norm() < door_.detection_radius &&
              heights.Overlaps(workspace_.scene.body(id).z + X_WR.z) &&
              RobotExists(workspace_.world(), RobotId(id.index()));
    });
    return found;
  }

  // The heights of the first leaf: all leaves of a door have the same.
  ZRange Heights() const {
    const BodyId leaf = workspace_.scene.body_of(door_.leaves.front().object);
    return workspace_.scene.body(leaf).z + workspace_.bodies.X_WB(leaf).z;
  }

  std::optional<double> FirstContactOfLeaves(double rate, double duration) const {
    std::optional<double> first;
    for (const DoorLeaf& leaf : door_.leaves) {
      const BodyId body = workspace_.scene.body_of(leaf.object);
      const Motion motion{workspace_.bodies.X_WB(body), {rate * leaf.shift, 0.0, rate * leaf.turn}, 0.0, duration};
      const std::vector<ConvexPiece> obstacles = ObstaclesOf(body, motion);
      if (obstacles.empty()) continue;
      const std::optional<Contact> contact = FirstContactWith(obstacles, MoverOf(workspace_.scene, body), motion);
      // All leaves open together, so that the earliest contact of any is that of the door.
      if (contact && (!first || contact->time < *first)) first = contact->time;
    }
    return first;
  }

  // The pieces of the bodies near the motion. Walls are none of them: a leaf slides into or beside its wall.
  std::vector<ConvexPiece> ObstaclesOf(BodyId leaf, const Motion& motion) const {
    const double radius = workspace_.scene.body(leaf).radius;
    Rectangle box = Rectangle::Around(motion.X_WF.translation(), radius);
    box.Extend(Rectangle::Around(motion.After(motion.duration).translation(), radius));
    return workspace_.PiecesNear(box);
  }

  void MoveTo(double opening) {
    state_.opening = opening;
    for (const DoorLeaf& leaf : door_.leaves) {
      Pose X_WH = leaf.X_WH_at(opening);
      X_WH.z = workspace_.next.objects[leaf.object.index()].X_WO.z;  // the lift of a cabin changes it
      workspace_.MoveObject(leaf.object, X_WH);
      // A leaf does not carry objects: one on its top edge looks for another support.
      for (std::size_t i = 0; i < workspace_.next.objects.size(); ++i) {
        const std::optional<ModelId>& below = workspace_.next.objects[i].support;
        if (below && workspace_.scene.object_of(*below) == leaf.object) workspace_.needs_support[i] = 1;
      }
    }
  }

  StepWorkspace& workspace_;
  const DoorDescription& door_;
  DoorState& state_;
  const std::optional<bool> is_asked_for_;
};

// The doors that people ask for (PersonState::door). A door that is not operated stays as it is for people, too.
std::vector<std::optional<bool>> AskedFor(const StepWorkspace& workspace) {
  const WorldDescription& world = workspace.world();
  std::vector<std::optional<bool>> asked(world.doors.size());
  if (world.people.empty()) return asked;
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    if (world.doors[i].is_operated) asked[i] = false;
  }
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    const std::uint32_t door = workspace.next.people[i].door;
    if (door == 0 || !asked[door - 1] || world.model(world.people[i].root).removed) continue;
    asked[door - 1] = true;
  }
  return asked;
}

}  // namespace

void MoveDoors(const TickOrders& orders, StepWorkspace& workspace) {
  const std::vector<DoorDescription>& doors = workspace.world().doors;
  if (doors.empty()) return;
  // Of the orders of robots the widest opening counts, whatever the order of robots: one that lets another pass is not
  // shut in by a third. An order of a robot in this tick replaces that of a tool, which is only the target until then.
  std::vector<std::optional<double>> targets(doors.size());
  orders.ForEachOfRobots<DoorOrder>([&](RobotId, const DoorOrder& order) {
    std::optional<double>& target = targets[order.door];
    target = std::max(target.value_or(0.0), order.opening);
  });
  orders.ForEachInput<DoorOrder>([&](const std::optional<RobotId>&, const DoorOrder& order) {
    workspace.next.doors[order.door].target = order.opening;
  });
  const std::vector<std::optional<bool>> asked = AskedFor(workspace);
  for (std::size_t i = 0; i < doors.size(); ++i) {
    if (targets[i] && doors[i].is_operated) workspace.next.doors[i].target = *targets[i];
    DoorTurn(workspace, i, asked[i]).Act();
  }
}

// A door or lift is known by its numbers to orders, lanes and the routes of people, which an edit would not follow; a
// level by its height, which lanes, places and people have too.
Status CheckIsMovable(const WorldDescription& world, ModelId root) {
  for (const LevelDescription& level : world.levels) {
    if (world.model(root).name != level.name || world.model(root).X_PM.z != level.z) continue;
    return Error{{}, "level '" + level.name + "' is a part of the building, and cannot be moved or deleted"};
  }
  for (const DoorDescription& door : world.doors) {
    const std::string& name = world.model(door.model).name;
    for (const DoorLeaf& leaf : door.leaves) {
      if (world.objects[leaf.object.index()] != root) continue;
      return Error{{}, "'" + world.model(root).name + "' is a leaf of door '" + name + "', which alone moves it"};
    }
    if (IsInTree(world, door.model, root)) {
      return Error{{}, "door '" + name + "' can be opened and closed in a run, but not moved or deleted"};
    }
  }
  for (const LiftDescription& lift : world.lifts) {
    if (world.objects[lift.cabin.index()] != root && !IsInTree(world, lift.model, root)) continue;
    return Error{{}, "lift '" + world.model(lift.model).name + "' can be called in a run, but not moved or deleted"};
  }
  return {};
}

}  // namespace troupe
