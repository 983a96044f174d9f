// Lifts (step_workspace.h: CallLifts, MoveLifts). A lift is its state: a height, a destination floor and the robot that
// has its session. CallLifts runs before the doors move and MoveLifts after them, so that doors that close completely
// in a tick let the cabin depart in the same one.
//
// Safety is by the doors alone: a cabin moves only while every door of every floor of the lift is exactly closed, and
// doors are told to be open only at the floor where the cabin stands. So no order of robots, tools or people can move a
// cabin with an open door.
//
// The doors that open at a floor are coupled: where a body stops a leaf that closes, all of them open again, all the
// way, before they close once more. `held` of their states keeps that between ticks.
//
// A cabin carries all bodies whose origin is in it, with their payloads, and stops at the first contact of any of these
// with a body outside; it tries again in each tick, with `blocked` set. The cabin itself passes through static models,
// because floors of a building have no holes at shafts; what sticks out beside it does not.
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
// session or proposes nothing: it is deleted, has lost its agent or its energy, and would keep the lift for ever.
void ExecuteCalls(std::size_t lift, const TickOrders& orders, LiftState& state) {
  if (state.session && orders.proposals[state.session->index()] == nullptr) state.session.reset();
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

// The origin of a body is within the outline of the cabin, and not below its floor or above its top.
bool IsInCabin(const StepWorkspace& workspace, const LiftDescription& lift, const Pose& X_WB) {
  const BodyId body = workspace.scene.body_of(lift.cabin);
  const Body& cabin = workspace.scene.body(body);
  const Pose& X_WC = workspace.bodies.X_WB(body);
  const Vec2 p_C = Transform2(X_WC).InverseTransform(X_WB.translation());
  const double above = X_WB.z - X_WC.z;
  if (!(above >= -kFloorSlack && above <= cabin.z.max + kFloorSlack)) return false;
  Rectangle outline = Rectangle::Nothing();  // in the frame of the cabin
  for (const ConvexPiece& piece : cabin.pieces) outline.Extend(BoundingBox(piece.vertices));
  return p_C.x() > outline.min_x && p_C.x() < outline.max_x && p_C.y() > outline.min_y && p_C.y() < outline.max_y;
}

// More is in the cabin than the lift carries.
bool IsOverloaded(const StepWorkspace& workspace, std::size_t lift) {
  const LiftDescription& description = workspace.world().lifts[lift];
  if (!IsLimited(description)) return false;
  CabinLoad load = RobotsInCabin(workspace, lift);
  for (std::size_t i = 0; i < workspace.next.people.size(); ++i) {
    const bool is_inside = !workspace.world().model(workspace.world().people[i].root).removed &&
                           IsInCabin(workspace, description, workspace.next.people[i].X_WP);
    if (is_inside) load.AddPerson();
  }
  return !load.IsWithin(description);
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

  // Around the cabin, in its frame C.
  Rectangle Outline() const {
    Rectangle outline = Rectangle::Nothing();
    for (const ConvexPiece& piece : workspace_.scene.body(Cabin()).pieces) outline.Extend(BoundingBox(piece.vertices));
    return outline;
  }

  bool IsInside(const Pose& X_WB) const { return IsInCabin(workspace_, lift_, X_WB); }

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
    const Pose X_CW = Inverse(motion.X_WF);
    // The cabin and its contents move as one body, in the frame of the cabin: swept once, as a stack of them is.
    std::vector<ConvexPiece> moving;
    std::vector<ConvexPiece> beside;
    Rectangle box = Rectangle::Nothing();
    const auto add = [&](BodyId body) {
      for (const ConvexPiece& piece : workspace_.bodies.pieces_in_world(body)) {
        box.Extend(BoundingBox(piece.vertices));
        moving.push_back(Transformed(piece, X_CW));
      }
    };
    add(Cabin());
    const std::size_t of_cabin = moving.size();
    for (const BodyId body : carried_) add(body);
    const Rectangle outline = Outline();
    for (std::size_t i = of_cabin; i < moving.size(); ++i) AppendPartsBeside(outline, moving[i], beside);
    std::optional<double> first = FirstContactOf(moving, workspace_.PiecesNear(box, carried_), motion);
    if (beside.empty()) return first;
    std::vector<ConvexPiece> walls;
    NearPieces near;
    workspace_.scene.static_index().Query(box, near);
    for (const ConvexPiece* const piece : near) walls.push_back(*piece);
    const std::optional<double> with_wall = FirstContactOf(beside, walls, motion);
    if (with_wall && (!first || *with_wall < *first)) first = with_wall;
    return first;
  }

  // The convex parts of a piece beyond each side of a box in its frame.
  static void AppendPartsBeside(const Rectangle& box, const ConvexPiece& piece, std::vector<ConvexPiece>& parts) {
    const struct {
      Vec2 outwards;
      double reach;  // m along `outwards`
    } sides[] = {
        {{1.0, 0.0}, box.max_x}, {{-1.0, 0.0}, -box.min_x}, {{0.0, 1.0}, box.max_y}, {{0.0, -1.0}, -box.min_y}};
    for (const auto& side : sides) {
      ConvexPiece part = piece;
      part.vertices.clear();
      double deepest = 0.0;  // m beyond the side
      for (std::size_t i = 0; i < piece.vertices.size(); ++i) {
        const Vec2& a = piece.vertices[i];
        const Vec2& b = piece.vertices[(i + 1) % piece.vertices.size()];
        const double at_a = a.dot(side.outwards) - side.reach;
        const double at_b = b.dot(side.outwards) - side.reach;
        deepest = std::max(deepest, at_a);
        if (at_a > 0.0) part.vertices.push_back(a);
        if ((at_a > 0.0) != (at_b > 0.0)) part.vertices.push_back(a + at_a / (at_a - at_b) * (b - a));
      }
      // A body that touches the side sticks out by rounding only.
      if (deepest > kNoticeableDepth) parts.push_back(std::move(part));
    }
  }

  // s; of pieces in the frame of the cabin with obstacles in W.
  static std::optional<double> FirstContactOf(const std::vector<ConvexPiece>& pieces,
                                              const std::vector<ConvexPiece>& obstacles, const Motion& motion) {
    if (pieces.empty() || obstacles.empty()) return std::nullopt;
    Mover mover;
    mover.pieces = pieces;
    mover.z = pieces.front().z;
    for (const ConvexPiece& piece : pieces) {
      mover.z = {std::min(mover.z.min, piece.z.min), std::max(mover.z.max, piece.z.max)};
      for (const Vec2& vertex : piece.vertices) mover.radius = std::max(mover.radius, vertex.norm());
    }
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

// Opens the doors of the floor at which the lift stands, and closes all others. A lift with too much in its cabin
// stays.
void OperateDoors(const LiftDescription& lift, const LiftState& state, std::vector<DoorState>& doors) {
  const auto is_at = [&](const LiftFloor& floor) { return floor.z == state.z; };
  const bool is_at_floor = is_at(lift.floors[state.floor]);
  const auto at =
      is_at_floor ? lift.floors.begin() + state.floor : std::find_if(lift.floors.begin(), lift.floors.end(), is_at);
  const bool stands = is_at_floor || (state.overloaded && at != lift.floors.end());
  bool reopens = false;
  if (!stands && at != lift.floors.end()) {
    const auto has = [&](auto is) {
      return std::any_of(at->doors.begin(), at->doors.end(), [&](std::size_t door) { return is(doors[door]); });
    };
    const bool is_held = has([](const DoorState& door) { return door.held; });
    const bool is_blocked = has([](const DoorState& door) { return door.blocked; });
    // From a contact while they close until they are open, or cannot open further.
    reopens = is_held ? !is_blocked && has([](const DoorState& door) { return door.opening != 1.0; }) : is_blocked;
  }
  for (const LiftFloor& floor : lift.floors) {
    for (const std::size_t door : floor.doors) {
      doors[door].target = 0.0;
      doors[door].held = false;
    }
  }
  // After the others: a door may serve several floors.
  if (at == lift.floors.end()) return;
  for (const std::size_t door : at->doors) {
    doors[door].target = stands ? 1.0 : 0.0;
    doors[door].held = reopens;
  }
}

}  // namespace

CabinLoad RobotsInCabin(const StepWorkspace& workspace, std::size_t lift) {
  const WorldDescription& world = workspace.world();
  CabinLoad load;
  for (std::size_t i = 0; i < workspace.next.robots.size(); ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    if (!IsInCabin(workspace, world.lifts[lift], workspace.next.robots[i].X_WR)) continue;
    ++load.bodies;
    load.mass += world.model(world.robots[i].root).power.mass;
  }
  return load;
}

void CallLifts(const TickOrders& orders, StepWorkspace& workspace) {
  const std::vector<LiftDescription>& lifts = workspace.world().lifts;
  for (std::size_t i = 0; i < lifts.size(); ++i) {
    LiftState& state = workspace.next.lifts[i];
    ExecuteCalls(i, orders, state);
    // Only at a floor: on its way it has what it has.
    const bool is_at_floor = std::any_of(lifts[i].floors.begin(), lifts[i].floors.end(),
                                         [&](const LiftFloor& floor) { return floor.z == state.z; });
    state.overloaded = is_at_floor && IsOverloaded(workspace, i);
  }
  ServePeople(workspace);
  for (std::size_t i = 0; i < lifts.size(); ++i) OperateDoors(lifts[i], workspace.next.lifts[i], workspace.next.doors);
}

void MoveLifts(StepWorkspace& workspace) {
  const std::vector<LiftDescription>& lifts = workspace.world().lifts;
  for (std::size_t i = 0; i < lifts.size(); ++i) {
    LiftState& state = workspace.next.lifts[i];
    state.blocked = false;
    bool may_move = state.z != lifts[i].floors[state.floor].z && !state.overloaded;
    for (const LiftFloor& floor : lifts[i].floors) {
      for (const std::size_t door : floor.doors) {
        may_move = may_move && workspace.next.doors[door].opening == 0.0;
      }
    }
    if (may_move) CabinMotion(workspace, lifts[i], state).Act();
  }
}

}  // namespace troupe
