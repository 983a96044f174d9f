// StepWorkspace: a state between two ticks, shared by the parts of a step. Private to this folder.
#pragma once

#include <utility>
#include <vector>

#include "common/model/event.h"
#include "common/model/world_state.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"

namespace troupe {

struct StepWorkspace {
  StepWorkspace(const Scene& scene_in, const WorldState& state) : StepWorkspace(scene_in, state, BodyIndex(scene_in)) {}
  // `index`: of the same scene, at any state.
  StepWorkspace(const Scene& scene_in, const WorldState& state, BodyIndex index)
      : scene(scene_in),
        next(state),
        bodies(std::move(index)),
        needs_support(state.objects.size(), false),
        lowered(state.objects.size(), 0.0) {
    bodies.Assign(state);
  }

  const Scene& scene;
  WorldState next;
  BodyIndex bodies;  // always at `next`
  std::vector<Event> robot_events;
  std::vector<Event> object_events;

  // By object: its support has to be found again, because it was released or touched, or its support moved down.
  std::vector<bool> needs_support;
  std::vector<double> lowered;  // m that its support moved down, so that it follows without falling

  const WorldDescription& world() const { return scene.world(); }
  double seconds() const { return world().interval_seconds(); }

  void MoveObject(ObjectId object, const Pose& X_WO) {
    next.objects[object.index()].X_WO = X_WO;
    bodies.Move(scene.body_of(object), X_WO);
  }
  // A robot or a joint has touched `other`: an object that is still at its place in the file may fall from now on.
  void Touch(const std::optional<ModelId>& other) {
    const std::optional<ObjectId> object = other ? scene.object_of(*other) : std::nullopt;
    if (object && next.objects[object->index()].mode == ObjectMode::kPlaced) needs_support[object->index()] = true;
  }
};

}  // namespace troupe
