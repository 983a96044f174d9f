// StepWorkspace: a state between two ticks, shared by the parts of a step. Private to this folder.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
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
  // By object: its support has to be found again, because it was released or touched, or its support moved down.
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

}  // namespace troupe
