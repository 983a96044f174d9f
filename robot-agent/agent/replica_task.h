// ReplicaTask: makes or changes the replica of an agent, or lets its robots remember states of the past. It may last
// long, and a gateway may have a DDS participant, whose end waits for all threads of DDS: so a task must not run, nor
// end, on a thread that delivers messages or while such a thread waits for the caller.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/equal_memory.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/agent_options.h"
#include "robot-agent/agent/replica.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

// Of an agent, for its replica.
struct AgentResources {
  ScanLog* scan_log = nullptr;  // null: none
  TickTrace* trace = nullptr;   // likewise
  FindEqualMemory find_map;     // memory for the map of the world; may be empty
};

struct ReplicaTask {
  bool is_new = false;  // the replica is made for `session`; false: it is changed
  // Of a change:
  bool fresh = false;         // all robots start anew
  Edition fresh_edition = 0;  // of the newest fresh start
  // Of a history, which the robots process: the state of their memory before and, as results, after. Null: none.
  std::unique_ptr<HistoryMessage> history;
  std::vector<std::string> own_robots;        // of the agent: some may be missing in the world at that time
  Edition world_edition = 0;                  // of the replica
  std::optional<Edition> made_at;             // the fresh edition of the robots; nothing: they are new
  std::optional<MemoryPlace> memory;          // of the robots
  std::unique_ptr<SessionMessage> put_aside;  // result: the world of the replica, if an older one has replaced it

  // With the world; null: the world is as before.
  std::unique_ptr<SessionMessage> session;
  // The replica to change; after a success the result, null if all robots of a new one are deleted. A replica to be
  // replaced ends first, because the names of its gateway may be those of the next one.
  std::unique_ptr<Replica> replica;
  std::uint64_t world_hash = 0;  // result: of the session's world
  Status outcome;                // result

  // Sets the results. REQUIRES: `options` and `resources` are those of all tasks of the agent.
  void Perform(const AgentOptions& options, const AgentResources& resources);

 private:
  Status Make(const AgentOptions& options, const AgentResources& resources);
  Status Change();
  Status Retrace();
  Status Retrace(HistoryEntry& entry);
};

}  // namespace troupe
