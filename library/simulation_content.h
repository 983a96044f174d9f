// The members of a simulation and of a snapshot.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/model/proposal.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "robot-agent/robot/robot.h"
#include "troupe/event.h"
#include "troupe/order.h"
#include "troupe/simulation.h"
#include "troupe/world_state.h"
#include "worldfile/load_world.h"

namespace troupe {

// What a simulation was loaded from, for models that are spawned later.
struct SimulationOrigin {
  WorldSource world;                      // without a path: there is no file
  std::optional<std::string> controller;  // of robots without one
  bool runs_controllers = true;
};

// Never changes once it is in a snapshot.
struct Snapshot::Content {
  std::shared_ptr<const SimulationOrigin> origin;          // never null
  std::vector<std::shared_ptr<const Scene>> robot_scenes;  // in which robots were made; these point into them
  std::shared_ptr<const Scene> scene;                      // shared by a simulation and its snapshots
  std::shared_ptr<const WorldState> state;                 // never null
  std::vector<Event> events;                               // of the last tick
  std::vector<std::unique_ptr<Robot>> robots;              // by id; those of removed robots stay, without decisions
  std::vector<ExternalCommand> commands;                   // by id
  std::vector<Input> inputs;                               // of the next tick
  std::uint32_t goals = 0;                                 // that were sent
  std::vector<std::string> failures;

  // The error is a controller that cannot be copied.
  Result<Content> Copy() const;
};

struct Simulation::Impl {
  explicit Impl(Snapshot::Content start);

  // Replaces the present content; `bodies` follow.
  void Assign(Snapshot::Content content);

  Snapshot::Content now;
  BodyIndex bodies;  // at now.state between calls
  std::vector<Warning> warnings;
  std::vector<Proposal> proposals;         // that entered the last step
  std::vector<Input> inputs;               // likewise
  std::vector<std::string> reports;        // since the last call of Step began
  std::vector<FleetOutput> fleet_outputs;  // likewise
};

}  // namespace troupe
