// The members of a simulation and of a snapshot. Private to this folder.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/model/proposal.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "robot-agent/robot/external_command.h"
#include "robot-agent/robot/robot.h"
#include "troupe/event.h"
#include "troupe/simulation.h"
#include "troupe/world_state.h"

namespace troupe {

// Never changes once it is in a snapshot.
struct Snapshot::Content {
  std::shared_ptr<const Scene> scene;  // shared by a simulation and its snapshots; robots point into it
  WorldState state;
  std::vector<Event> events;                   // of the last tick
  std::vector<std::unique_ptr<Robot>> robots;  // by id
  std::vector<ExternalCommand> commands;       // by id
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
  std::vector<Proposal> proposals;   // of one step
  std::vector<std::string> reports;  // since the last call of Step began
};

}  // namespace troupe
