// ReplicaTask: makes or changes the replica of an agent, or lets its robots process states of the past. It may last
// long, and a gateway may have a DDS participant, whose end waits for all threads of DDS: so a task must not run, nor
// end, on a thread that delivers messages or while such a thread waits for the caller.
//
// A task owns the robots while it runs: the protocol has none meanwhile, and gets them back, or a replica of no use
// stays in the task. So no lock is held during a task, however long it takes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "common/spatial/scene_cache.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/agent_host.h"
#include "robot-agent/agent/replica.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"

namespace troupe {

// The resources of an agent, for its replica.
struct AgentResources {
  ScanLog* scan_log = nullptr;  // null: none
  TickTrace* trace = nullptr;   // null: none
  // AgentEndpoint::FindWorld; may be empty.
  std::function<std::optional<PreparedWorld>(const WorldDescription&)> find_world = {};
  std::shared_ptr<SceneCache> scenes = {};  // of the process; null: each world has a scene of its own
};

// The robots of an agent, in their replica of the world.
struct AgentRobots {
  std::unique_ptr<Replica> replica;            // null: not made yet, or the agent has no robots left
  std::vector<std::string> names;              // the world of a history may lack some of them
  std::uint64_t world_hash = 0;                // of the replica's world
  Edition world_edition = 0;                   // of the replica's world
  std::optional<Edition> fresh_edition;        // at which they started again; nothing: they have processed no frame yet
  std::optional<ControllerCheckpoint> memory;  // nothing: they are new
  bool log_is_marked = false;                  // the scan log has fresh_edition
};

struct ReplicaTask {
  // Makes the replica for the world of a session. The previous one ends first: the names of its gateway may be the
  // same.
  struct Making {
    std::unique_ptr<SessionMessage> session;
  };
  // Applies an edit of the world, a fresh start of all robots, or both.
  struct Changing {
    std::unique_ptr<SessionMessage> session;  // with the world; null: it is as before
    bool fresh = false;
    Edition fresh_edition = 0;  // of the newest fresh start
  };
  // Leaves robots to another agent.
  struct Leaving {
    std::set<std::string> robots;
  };
  // The robots process the states that follow their memory.
  struct Retracing {
    std::unique_ptr<HistoryMessage> history;
    std::unique_ptr<SessionMessage> later_world = {};  // result: the replica's world, if the history has an older one
  };
  using Work = std::variant<Making, Changing, Leaving, Retracing>;

  Work work;
  AgentRobots robots;  // before the task; after a success the result
  Status outcome;      // result

  // Sets the results. REQUIRES: all tasks of the agent have the same `options` and `resources`.
  void Perform(const AgentOptions& options, const AgentResources& resources);

 private:
  Status Make(const SessionMessage& session, const AgentOptions& options, const AgentResources& resources);
  Status Change(const Changing& change, const AgentResources& resources);
  Status Retrace(Retracing& past, const AgentResources& resources);
  Status Retrace(HistoryEntry& entry, Retracing& past, const AgentResources& resources);
};

}  // namespace troupe
