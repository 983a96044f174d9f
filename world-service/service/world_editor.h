// WorldEditor: applies edits to the world of a run, one after another: the next edition, the members that an edit
// concerns, and the agents that new robots need. docs/tick-protocol.md describes editions.
//
// An edit is all or nothing: everything that may fail (names, room, permissions, memory) is checked on the edited copy
// before the run changes; Commit itself cannot be refused. Descriptions and states are values, so the copy costs memory
// for a moment, and no edit has to be undone.
//
// Editions count up by one with each edit. `world_edition` is the newest edition that changed the description,
// `fresh_edition` the newest after which robots begin without memory (load, reset, rewind).
//
// Passive, as TickEngine; called by RunControl in a quiescent pause.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "world-service/core/edit_world.h"
#include "world-service/service/live_run.h"
#include "world-service/service/tick_engine.h"

namespace troupe {

// Read from a file for a request: the world to load, or one whose only entity is to be spawned.
struct RequestedWorld {
  std::shared_ptr<const WorldDescription> world = {};
  // A spawned robot without a ROS domain of its own has the first free one from this on; nothing: none.
  std::optional<std::uint32_t> ros_domains_from = {};
};

class WorldEditor {
 public:
  // Both outlive the editor.
  WorldEditor(LiveRun& run, TickEngine& engine);

  // The entity called `name` that was deleted last, for a spawn; never null. The error: it is a person, or there is
  // none among the last kMaxDeleted.
  Result<std::shared_ptr<const WorldDescription>> Deleted(const std::string& name) const;

  // Applies an edit and publishes the edited frame, which is paused. Returns the request with the name that a spawned
  // entity has. After an error nothing has changed. REQUIRES: the pause is quiescent.
  Result<control::Request> Apply(control::Request request, const RequestedWorld& requested, double now);
  // Publishes the state to which a request has rewound the run; it is paused. REQUIRES: the pause is quiescent.
  void Rewind(const control::Request& request, const RewoundRun& rewound, double now);
  // A line for users about a request that is executed.
  void ReportRequest(const control::Request& request);
  // Deletes an entity whose spawn has failed.
  void RevokeSpawn(const std::string& name, double now);

  // An agent has joined for robots.
  void OnJoined(const std::vector<RobotId>& robots);
  // Robots of an edit that have no agent yet; the pause is not quiescent before they have.
  const std::vector<RobotId>& robots_without_agent() const { return run_.newcomers; }
  // Does not wait for these any longer once the start timeout has passed since the edit; the error names them.
  Status CheckTimeout(double now);
  // Names of new robots, not returned before, for which agents have to be started.
  std::vector<std::string> DrainNewRobots();

 private:
  // As ApplyEdit; an error without memory for the edited world.
  Result<EditedWorld> ApplyIfRoom(const AppliedEdit& edit) const;
  // As ServiceOptions::check_world.
  Status CheckWorld(const WorldDescription& world) const;
  Status CheckSpawned(const WorldDescription& world, const std::string& name) const;
  // `spawned`, a world with one robot, which has the first free ROS domain from `first` on.
  Result<WorldDescription> WithRosDomain(std::uint32_t first, const WorldDescription& spawned) const;
  void Commit(EditedWorld edited, const AppliedEdit& edit, double now);
  void Publish(FrameMessage next, const AppliedEdit& edit, double now, bool is_recorded = false);
  // `next`: the frame that is to be published, with its editions.
  void ChangeWorld(std::shared_ptr<const Scene> scene, bool fresh, const FrameMessage& next);

  LiveRun& run_;
  TickEngine& engine_;
  std::shared_ptr<const Scene> original_;  // of the world as loaded
  // While an edit is applied, that of the world before, to which other parts refer if one of them throws.
  std::shared_ptr<const Scene> previous_scene_;
  double newcomers_since_ = 0.0;  // wall time of the newest edit, s
  std::vector<std::string> new_robots_;
  std::deque<DeletedEntity> deleted_;  // the newest last
};

}  // namespace troupe
