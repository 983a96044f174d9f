// StepWorkspace: a state between two ticks, shared by the parts of a step: motion, doors, lifts, gravity, people,
// devices. Private to this folder.
//
// StepMemory owns the next state, which begins as a copy of the present one and becomes the result, and the index of
// its bodies. A StepWorkspace is a view of it for one thread: of the whole world, or of one island of robots.
// Invariant: a part that moves a body moves it in the state and in the index, by MoveObject or by BodyIndex::Move, so
// that the index is always at `next` for the bodies of the workspace.
//
// Threads: islands write disjoint rows of the same vectors. That is why flags are bytes and no std::vector<bool>, whose
// neighbouring elements share a word.
//
// Events gather in two lists, of robots and of objects: the robots' are sorted by id at the end, so that the order in
// which robots acted does not show.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/model/proposal.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/spatial/sweep.h"
#include "troupe/event.h"
#include "troupe/world_state.h"

namespace troupe {

// The state of a whole world.
struct StepMemory {
  StepMemory(const Scene& scene, const WorldState& state) : StepMemory(scene, state, BodyIndex(scene)) {}
  // `index`: of the same scene, at any state.
  StepMemory(const Scene& scene, const WorldState& state, BodyIndex index)
      : next(state),
        bodies(std::move(index)),
        needs_support(state.objects.size(), 0),
        lowered(state.objects.size(), 0.0) {
    bodies.Assign(state);
    for (std::size_t i = 0; i < state.objects.size(); ++i) objects.emplace_back(i);
    for (std::size_t i = 0; i < scene.world().grippers.size(); ++i) grippers.emplace_back(i);
  }

  WorldState next;
  BodyIndex bodies;  // always at `next`
  // Not 0 for an object whose support has to be found again, because it was released or touched, or its support moved
  // down.
  std::vector<std::uint8_t> needs_support;
  std::vector<double> lowered;    // m that its support moved down, so that it follows without falling
  std::vector<ObjectId> objects;  // all, in id order, like the next
  std::vector<GripperId> grippers;
};

// The part of it that one thread changes: all, or an island.
struct StepWorkspace {
  StepWorkspace(const Scene& scene_in, StepMemory& memory)
      : StepWorkspace(scene_in, memory, memory.bodies, memory.objects, memory.grippers) {}
  // The island of these objects and grippers, in id order. `index`: of the same scene, at the state before the step but
  // for the bodies of islands that were stepped with it.
  StepWorkspace(const Scene& scene_in, StepMemory& memory, BodyIndex& index, std::span<const ObjectId> objects_in,
                std::span<const GripperId> grippers_in)
      : scene(scene_in),
        next(memory.next),
        bodies(index),
        needs_support(memory.needs_support),
        lowered(memory.lowered),
        objects(objects_in),
        grippers(grippers_in) {}

  const Scene& scene;
  WorldState& next;
  BodyIndex& bodies;
  std::vector<std::uint8_t>& needs_support;
  std::vector<double>& lowered;
  std::span<const ObjectId> objects;
  std::span<const GripperId> grippers;
  std::vector<Event> robot_events;
  std::vector<Event> object_events;

  const WorldDescription& world() const { return scene.world(); }
  double seconds() const { return world().interval_seconds(); }

  // A leaf of a door or a cabin of a lift.
  bool IsMounted(ObjectId object) const { return next.objects[object.index()].mode == ObjectMode::kMounted; }
  bool IsMounted(BodyId body) const {
    const std::optional<ObjectId> object = scene.object_of(body);
    return object && IsMounted(*object);
  }
  // The pieces of the bodies near `box` that a leaf or a cabin may hit: not other leaves and cabins.
  std::vector<ConvexPiece> PiecesNear(const Rectangle& box, std::span<const BodyId> except = {}) const {
    std::pmr::vector<BodyId> near;
    bodies.Query(box, near);
    std::vector<ConvexPiece> pieces;
    for (const BodyId body : near) {
      if (IsMounted(body) || std::binary_search(except.begin(), except.end(), body)) continue;
      const std::vector<ConvexPiece>& its = bodies.pieces_in_world(body);
      pieces.insert(pieces.end(), its.begin(), its.end());
    }
    return pieces;
  }
  void MoveObject(ObjectId object, const Pose& X_WO) {
    next.objects[object.index()].X_WO = X_WO;
    bodies.Move(scene.body_of(object), X_WO);
  }
  // A robot or a joint has touched `other`: an object that is still at its place in the file may fall from now on.
  void Touch(const std::optional<ModelId>& other) {
    const std::optional<ObjectId> object = other ? scene.object_of(*other) : std::nullopt;
    if (object && next.objects[object->index()].mode == ObjectMode::kPlaced) needs_support[object->index()] = 1;
  }
};

// The orders of a tick: first of tools, then of the proposals of robots. All are valid.
struct TickOrders {
  std::span<const Input> inputs;               // in the sequence in which they are executed
  std::span<const Proposal* const> proposals;  // by robot, null where there is none

  // Calls use(robot, order) for each order of a kind; `robot` is nothing for one of a tool for the building.
  template <typename Kind, typename Use>
  void ForEachInput(const Use& use) const {
    for (const Input& input : inputs) {
      if (const auto* const order = std::get_if<Kind>(&input.order)) use(input.robot, *order);
    }
  }
  template <typename Kind, typename Use>
  void ForEachOfRobots(const Use& use) const {
    for (const Proposal* const proposal : proposals) {
      if (proposal == nullptr) continue;
      for (const Order& any : proposal->orders) {
        if (const auto* const order = std::get_if<Kind>(&any)) use(proposal->robot, *order);
      }
    }
  }
};

// The devices of robots that a step switches and turns: lights and cameras; and the texts that robots say.

// Executes these orders, and adds an event for each text.
void OperateDevices(const TickOrders& orders, StepWorkspace& workspace);

// At the end of a tick: the velocities that tools set, of which inertial measurement units measure no acceleration.
void SetTwists(std::span<const Input> inputs, StepWorkspace& workspace);

// The energy of a step: the consumption of models, and the exchange between models that touch.

// True for a robot whose drive is fed by an empty store: it executes no proposal.
bool IsOutOfEnergy(const Scene& scene, const WorldState& state, RobotId robot);

// Empties and fills the stores by one tick, after the robots have acted. First each store loses what its models
// consume. Then models with `take_watts` take from models with `give_watts` that touch them, each at its rate at the
// most, in the order of the takers, then of the givers, as far as there is energy and room. Models touch if blocks of
// theirs or of their children are within 1 mm of each other, in footprint and in height; they need not collide. Models
// of one body do not touch each other, nor do static models. A store that becomes empty is an event of its robot.
void ExchangeEnergy(StepWorkspace& workspace);

// The radio messages of a step.
// Removes the messages that have arrived before the tick of `state`, and adds the messages of the proposals, sent in
// that tick. `by_robot`: the proposals by robot, null where there is none. REQUIRES: they are valid.
void Transmit(const WorldDescription& world, std::span<const Proposal* const> by_robot, WorldState& state);

// The velocities of inertial measurement units, which a state keeps for the accelerations of the next one.

// Keeps the present velocities in `state.imus`: of all units, or of one robot's units.
// REQUIRES: `bodies` is an index of `scene` at `state`.
void KeepVelocities(const Scene& scene, const BodyIndex& bodies, WorldState& state,
                    std::optional<RobotId> robot = std::nullopt);

// The same after an edit of a robot, so that its units measure no acceleration by it.
void KeepVelocities(const Scene& scene, RobotId robot, WorldState& state);

// Doors, after the robots have acted: each moves towards its target, or opens for a robot in its reach, up to the
// first contact of a leaf with a robot, a person or an object.
void MoveDoors(const TickOrders& orders, StepWorkspace& workspace);

// Lifts: before the doors move, the orders count, and each opens its doors where it stands at its floor and closes them
// elsewhere. After them, one whose doors are all closed moves towards its floor, with what stands in it.
void CallLifts(const TickOrders& orders, StepWorkspace& workspace);
void MoveLifts(StepWorkspace& workspace);

// The planned traffic of lanes: moves the plan on by the orders of the robots that take part, and grants their next
// moves.
void DirectTraffic(const TickOrders& orders, StepWorkspace& workspace);

// What the file of a world demands at the time of a tick, as orders of a tool.
std::vector<Input> TimedInputs(const WorldDescription& world, Tick tick);

// Rules of lanes and the switches of zones, before all that heeds them.
void RuleLanes(const TickOrders& orders, StepWorkspace& workspace);

// Cleaning zones, after all motion: the cells on which robots are count as covered.
void CoverZones(StepWorkspace& workspace);

// Decides which robot has which charger, and which place to wait for one.
void AssignChargers(const TickOrders& orders, StepWorkspace& workspace);

// Goods arrive, and robots get, load and deliver them.
void MoveGoods(const TickOrders& orders, StepWorkspace& workspace);

// What robots on their ways wait for, after the traffic: of the planned traffic by its plan, of others by their orders.
void UpdateWaits(const TickOrders& orders, StepWorkspace& workspace);

// Adds what has happened to robots on their ways between two states: long waits and their ends in the order of robots,
// then deadlocks that are broken, then lanes that are closed.
void AddTrafficEvents(const WorldDescription& world, const WorldState& before, const WorldState& now,
                      std::vector<Event>& events);

// Adds what doors, lifts and people have done between two states: doors in their order, then lifts,
// people, lanes, zones and goods.
void AddBuildingEvents(const Scene& scene, const WorldState& before, const WorldState& now, std::vector<Event>& events);

// Gravity: objects that have lost their support fall straight to the highest support under their footprint, and rest
// there.

// Sets the placed objects that touch a support from above to rest on it. Nothing moves.
void FindSupports(StepWorkspace& workspace);

// Robots take objects and put them down (LoadOrder), after the robots have moved.
void HandOverLoads(const TickOrders& orders, StepWorkspace& workspace);

// Moves falling objects, lands them and finds their supports, from the lowest up. Call it when all robots have moved.
void LetObjectsFall(StepWorkspace& workspace);

// Motion of robots: the base along its twist, and each joint along its axis, with their payloads.

// Moves a robot's base until its first contact, which is returned.
std::optional<Contact> MoveBase(StepWorkspace& workspace, RobotId robot, const Twist& twist);

// Moves one joint to its limit, or to the first contact, which is returned. Objects that rest on a part that moves down
// follow it and do not stop it; a held object does.
std::optional<Contact> MoveJoint(StepWorkspace& workspace, JointId joint, double velocity);

// Gripping and releasing objects.

// Ends a gripper's hold. Another gripper that has the object between its pads holds it from then on; otherwise the
// object is free.
void Release(StepWorkspace& workspace, GripperId gripper);

// The motion of one finger in this tick.
struct FingerMotion {
  double velocity = 0.0;           // demanded, m/s
  std::optional<Contact> contact;  // that stopped it
};

// Updates the contacts of a gripper's pads, and grips an object that touches both.
void Grip(StepWorkspace& workspace, GripperId gripper, const FingerMotion& left, const FingerMotion& right);

// Ends the contacts of grippers with objects that other grippers hold and have removed from between their pads.
void DropLostObjects(StepWorkspace& workspace);

}  // namespace troupe
