// Lifts (step_workspace.h: CallLifts, MoveLifts). A lift is its state: a height, a destination floor and the robot that
// has its session. CallLifts runs before the doors move and MoveLifts after them, so that doors that close completely
// in a tick let the cabin depart in the same one.
//
// Safety is by the doors alone: a cabin moves only while every door of every floor of the lift is exactly closed, and
// doors are told to be open only at the floor where the cabin stands. So no order of robots, tools or people can move a
// cabin with an open door.
//
// A cabin carries all bodies whose origin is in it, with their payloads, and stops at the first contact of any of these
// with a body outside; it tries again in each tick, with `blocked` set.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/spatial/convex_piece.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/lift_boarding.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// A body in a cabin may have sunk into its floor by this depth: far more than rounding.
constexpr double kFloorSlack = 1e-3;  // m

// A call of a tool ends the session. A robot that has the session is the only one whose orders count, until it ends the
// session or is removed.
void ExecuteCalls(const WorldDescription& world, std::size_t lift, const TickOrders& orders, LiftState& state) {
  if (state.session && !RobotExists(world, *state.session)) state.session.reset();
  // Tools before robots, as for all orders of a tick.
  orders.ForEachInput<LiftOrder>([&](const std::optional<RobotId>&, const LiftOrder& order) {
    if (order.lift != lift) return;
    state.session.reset();
    if (!order.ends) state.floor = static_cast<std::uint32_t>(order.floor);
  });
  // In the order of robot ids: of two robots that call in the same tick the first one gets the session.
  orders.ForEachOfRobots<LiftOrder>([&](RobotId robot, const LiftOrder& order) {
    if (order.lift != lift || (state.session && *state.session != robot)) return;
    state.session = order.ends ? std::nullopt : std::optional(robot);
    if (!order.ends) state.floor = static_cast<std::uint32_t>(order.floor);
  });
}

// One cabin on its way.
class CabinMotion {
 public:
  CabinMotion(StepWorkspace& workspace, const LiftDescription& lift, LiftState& state)
      : workspace_(workspace), lift_(lift), state_(state) {}

  // Towards its floor, up to the first contact of the cabin and what it carries with another body.
  void Act() {
    const double goal = lift_.floors[state_.floor].z;
    const double most = lift_.speed * workspace_.seconds();
    const double way = goal - state_.z;
    // Exactly the height of the floor at the end of the way: IsOpen, people and events compare for equality.
    const double end = std::fabs(way) <= most ? goal : state_.z + std::copysign(most, way);
    // Before the motion: the contents of the cabin are found at its old height.
    FindCarried();
    const Motion motion{
        workspace_.bodies.X_WB(Cabin()), {}, std::copysign(lift_.speed, way), std::fabs(end - state_.z) / lift_.speed};
    const std::optional<double> contact = FirstContactOf(motion);
    state_.blocked = contact.has_value();
    MoveTo(contact ? state_.z + motion.climb * *contact : end);
  }

 private:
  BodyId Cabin() const { return workspace_.scene.body_of(lift_.cabin); }

  // The origin of a body is within the outline of the cabin, and not below its floor or above its top.
  bool IsInside(const Pose& X_WB) const {
    const Body& cabin = workspace_.scene.body(Cabin());
    const Pose& X_WC = workspace_.bodies.X_WB(Cabin());
    const Vec2 p_C = Transform2(X_WC).InverseTransform(X_WB.translation());
    const double above = X_WB.z - X_WC.z;
    if (!(above >= -kFloorSlack && above <= cabin.z.max + kFloorSlack)) return false;
    Rectangle outline = Rectangle::Nothing();
    for (const ConvexPiece& piece : cabin.pieces) outline.Extend(BoundingBox(piece.vertices));
    return p_C.x() > outline.min_x && p_C.x() < outline.max_x && p_C.y() > outline.min_y && p_C.y() < outline.max_y;
  }

  bool IsCarried(ModelId model) const {
    const std::optional<BodyId> body = workspace_.scene.body_of(model);
    return body && (*body == Cabin() || std::binary_search(carried_.begin(), carried_.end(), *body));
  }

  // The robots, people and objects in the cabin, with their payloads.
  void FindCarried() {
    const std::size_t robots = workspace_.next.robots.size();
    std::vector<bool> objects(workspace_.next.objects.size(), false);
    for (std::size_t i = 0; i < robots; ++i) {
      if (IsInside(workspace_.next.robots[i].X_WR)) carried_.emplace_back(i);
    }
    for (std::size_t i = 0; i < workspace_.next.people.size(); ++i) {
      if (IsInside(workspace_.next.people[i].X_WP)) carried_.push_back(workspace_.scene.body_of(PersonId(i)));
    }
    // Stacks, and objects in grippers of robots in the cabin, whose origins may be outside: one more level in each
    // round, until nothing is added.
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t i = 0; i < objects.size(); ++i) {
        const ObjectState& object = workspace_.next.objects[i];
        if (objects[i] || object.mode == ObjectMode::kMounted) continue;
        const bool is_carried = object.holder ? IsCarried(workspace_.world().gripper(*object.holder).model)
                                              : (object.support && IsCarried(*object.support)) || IsInside(object.X_WO);
        if (!is_carried) continue;
        objects[i] = grown = true;
        carried_.emplace_back(robots + i);
      }
      std::sort(carried_.begin(), carried_.end());
    }
  }

  std::optional<double> FirstContactOf(const Motion& motion) const {
    // The cabin and its contents move as one body, in the frame of the cabin: swept once, as a stack of them is.
    std::vector<ConvexPiece> moving = workspace_.bodies.pieces_in_world(Cabin());
    for (const BodyId body : carried_) {
      const std::vector<ConvexPiece>& pieces = workspace_.bodies.pieces_in_world(body);
      moving.insert(moving.end(), pieces.begin(), pieces.end());
    }
    const Pose X_CW = Inverse(motion.X_WF);
    Rectangle box = Rectangle::Nothing();
    Mover mover;
    for (std::size_t i = 0; i < moving.size(); ++i) {
      box.Extend(BoundingBox(moving[i].vertices));
      moving[i] = Transformed(moving[i], X_CW);
      mover.z.min = i == 0 ? moving[i].z.min : std::min(mover.z.min, moving[i].z.min);
      mover.z.max = i == 0 ? moving[i].z.max : std::max(mover.z.max, moving[i].z.max);
      for (const Vec2& vertex : moving[i].vertices) mover.radius = std::max(mover.radius, vertex.norm());
    }
    mover.pieces = moving;
    const std::vector<ConvexPiece> obstacles = workspace_.PiecesNear(box, carried_);
    if (obstacles.empty()) return std::nullopt;
    const std::optional<Contact> contact = FirstContactWith(obstacles, mover, motion);
    return contact ? std::optional(contact->time) : std::nullopt;
  }

  void MoveTo(double z) {
    const double dz = z - state_.z;
    if (dz == 0.0) return;
    state_.z = z;
    // The heights of cabin and doors are computed from the heights at load, not added up: after any number of trips the
    // cabin is at its floor to the last bit.
    const double offset = z - lift_.floors[lift_.floor].z;  // from the heights at load
    const auto raise = [&](ObjectId object, double height) {
      Pose X_WO = workspace_.next.objects[object.index()].X_WO;
      X_WO.z = height;
      workspace_.MoveObject(object, X_WO);
    };
    raise(lift_.cabin, workspace_.world().model(workspace_.world().objects[lift_.cabin.index()]).X_PM.z + offset);
    for (const std::size_t door : lift_.cabin_doors) {
      for (const DoorLeaf& leaf : workspace_.world().doors[door].leaves) raise(leaf.object, leaf.X_WH.z + offset);
    }
    const auto raise_body = [&](BodyId body, Pose& X_WB) {
      X_WB.z += dz;
      workspace_.bodies.Move(body, X_WB);
    };
    for (const BodyId body : carried_) {
      if (const std::optional<ObjectId> object = workspace_.scene.object_of(body)) {
        ObjectState& state = workspace_.next.objects[object->index()];
        raise(*object, state.X_WO.z + dz);
        // It may have rested on the floor of the building.
        if (state.mode == ObjectMode::kResting) workspace_.needs_support[object->index()] = 1;
      } else if (const std::optional<PersonId> person = workspace_.scene.person_of(body)) {
        raise_body(body, workspace_.next.people[person->index()].X_WP);
      } else {
        raise_body(body, workspace_.next.robots[body.index()].X_WR);
      }
    }
  }

  StepWorkspace& workspace_;
  const LiftDescription& lift_;
  LiftState& state_;
  std::vector<BodyId> carried_;  // ascending
};

}  // namespace

void CallLifts(const TickOrders& orders, StepWorkspace& workspace) {
  const std::vector<LiftDescription>& lifts = workspace.world().lifts;
  for (std::size_t i = 0; i < lifts.size(); ++i) ExecuteCalls(workspace.world(), i, orders, workspace.next.lifts[i]);
  ServePeople(workspace);
  for (std::size_t i = 0; i < lifts.size(); ++i) {
    LiftState& state = workspace.next.lifts[i];
    const bool stands = state.z == lifts[i].floors[state.floor].z;
    for (const LiftFloor& floor : lifts[i].floors) {
      // All closed first, then the doors of the cabin's floor open again: a door that serves two floors
      // stays open.
      for (const std::size_t door : floor.doors) workspace.next.doors[door].target = 0.0;
    }
    if (!stands) continue;
    for (const std::size_t door : lifts[i].floors[state.floor].doors) workspace.next.doors[door].target = 1.0;
  }
}

void MoveLifts(StepWorkspace& workspace) {
  const std::vector<LiftDescription>& lifts = workspace.world().lifts;
  for (std::size_t i = 0; i < lifts.size(); ++i) {
    LiftState& state = workspace.next.lifts[i];
    state.blocked = false;
    bool may_move = state.z != lifts[i].floors[state.floor].z;
    for (const LiftFloor& floor : lifts[i].floors) {
      for (const std::size_t door : floor.doors) {
        may_move = may_move && workspace.next.doors[door].opening == 0.0;
      }
    }
    if (may_move) CabinMotion(workspace, lifts[i], state).Act();
  }
}

}  // namespace troupe
