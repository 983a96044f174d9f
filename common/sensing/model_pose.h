// The poses and colours of models as sensors see them. Private to this folder.
#pragma once

#include "common/sensing/sensor.h"

namespace troupe {

// X_WM of any model, static or moving.
inline Pose PoseOfModel(const SensedWorld& world, ModelId model) {
  return world.scene.body_of(model) ? world.bodies.X_WM(model) : world.scene.X_LM(model);
}

// The colour of a model at `tick`.
inline Color ColorOfModel(const SensedWorld& world, ModelId model, Tick tick) {
  const WorldDescription& description = world.scene.world();
  const std::optional<std::size_t> row = world.state != nullptr ? world.scene.light_of(model) : std::nullopt;
  const bool is_switched_on =
      row ? world.state->lights[*row].is_switched_on : description.model(model).blinking.is_switched_on;
  return ColorAt(description.model(model), static_cast<std::int64_t>(tick) * description.interval_ns, is_switched_on);
}

}  // namespace troupe
