// TickGate: the messages of a tick for which nodes are awaited, in one ROS domain. It counts them for /world/tick, lets
// each pass once, and holds them back until the awaited nodes can receive them.
//
// A volatile writer of DDS reaches only readers that have discovered it, and a message that is written again for a late
// one reaches all others twice. So as long as an awaited topic or node has never been heard of, the gate is closed at
// the start of the tick:
//
//   open    --Arm: something that is watched is unheard-->            closed: messages of streams are held
//   closed  --Tell, and all that is awaited is there and settled-->   asking: the agents show the tick to all readers
//   asking  --all have-->                                             open: what is held is written, then /world/tick
//
// An awaited program is settled when its nodes have answered a NodeProbe and no endpoint of the domain has come or gone
// for a while; without services for parameters, when that while was longer. In the tick in which it is awaited for the
// first time, readers that come later still make the agents show their topics again, to all readers: a node may make
// readers at any time. From its first answer on nothing is written twice, and no reader changes what another one
// receives. A program that has ended is awaited again: its successor, which may have come before the end was known, is
// probed, and the agents then show the topics that it reads again.
//
// Messages are the same if they have the same bytes on the same topic for the same tick: an agent that is started again
// shows its tick again, perhaps when the next one is armed. Messages of types without a time may be equal and not the
// same: these all pass.
//
// Used on the thread of the ParticipantServer; NoteReader and Call on any.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ros/participant/held_calls.h"
#include "ros/participant/node_probe.h"
#include "ros/participant/reusable_endpoints.h"
#include "ros/participant/topic_watch.h"

namespace troupe::ros {

class AgentEndpoints;

class TickGate {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  // The content of /world/tick without its list of topics.
  struct Announcement {
    std::uint32_t writer = 0;  // of the agent that has it
    TopicWatch::Announced tick;
  };

  // Both outlive this.
  TickGate(const RosParticipant& participant, TopicWatch& watch)
      : participant_(participant), watch_(watch), calls_(watch) {}

  // Messages are from now on of the tick with this text. False: they are already.
  bool Arm(const std::string& text);
  // The agents may show the tick to nodes from now on.
  void Show() { is_shown_ = true; }
  // A message of the agent's writer. `is_again`: it was shown again.
  void Write(AgentEndpoints& agent, std::uint32_t id, const ReusableWriter& writer, std::span<const std::byte> bytes,
             bool is_again);
  // All agents have shown the tick, which waits for these watches of the agent: nodes are to know of it.
  void Tell(AgentEndpoints& agent, const Announcement& announcement, std::set<std::uint32_t> awaited);
  // The tick that the agent has told waits for these from now on.
  void Await(const AgentEndpoints& agent, const std::set<std::uint32_t>& awaited);
  // The agent has shown the tick again.
  void OnShown(AgentEndpoints& agent);
  void Remove(AgentEndpoints& agent);
  // A writer of an agent has a new reader.
  void NoteReader();
  // A service of an agent is called. Update follows. From any thread.
  void Call(HeldCalls::Call call) { calls_.Add(std::move(call)); }
  // The calls of the agent's service that were not passed on.
  std::vector<HeldCalls::Call> TakeCalls(const AgentEndpoints& agent, std::uint32_t service) {
    return calls_.Take(agent, service);
  }
  // Continues, if what it waited for has come.
  void Update();
  // When it is to be called in any case.
  std::optional<Time> due() const { return due_; }

 private:
  struct Count {
    std::uint64_t messages = 0;
    std::optional<std::int64_t> stamp;  // of the newest, ns; none: the type has no header
  };
  struct Held {
    AgentEndpoints* agent;
    std::uint32_t writer;
    std::vector<std::byte> bytes;
    std::string topic;
    std::size_t hash;
  };
  // Of one text.
  struct Round {
    std::string text;
    std::map<std::string, Count> counts = {};  // by topic
    std::set<std::size_t> seen = {};           // hashes of messages with their topics
    std::vector<Held> held = {};
  };
  struct Told {
    AgentEndpoints* agent;
    Announcement announcement;
    std::set<std::uint32_t> awaited;                     // watches
    bool is_written = false;                             // nodes know of the tick
    std::optional<std::set<std::uint32_t>> absent = {};  // as the agent knows them
    std::set<std::uint32_t> calling = {};                // the same of those whose calls wait
  };

  void UpdateTick(Time now);
  void UpdateCalls();
  std::vector<TopicWatch::Unheard> FindAwaited() const;
  // Whether all programs are there; tells the agent which are not.
  bool ArePresent(const std::vector<TopicWatch::Unheard>& unheard, Time now);
  bool IsSettled(const std::vector<TopicWatch::Unheard>& unheard, Time now);
  bool HasProbed(const std::vector<TopicWatch::Unheard>& unheard, Time now);
  // Null if it cannot be made, as without the right to call the node (SROS 2).
  NodeProbe* FindProbe(dds_instance_handle_t program, const std::string& service);
  Time ChangedAt() const;
  void ShowToLateReaders(const std::vector<TopicWatch::Unheard>& unheard, Time now);
  void AskForLate(const std::vector<TopicWatch::Unheard>& unheard, Time now);
  void Ask(Time now);
  void Open();
  std::string ListOfTopics() const;
  void UpdateBy(Time time) { due_ = due_ ? std::min(*due_, time) : time; }

  const RosParticipant& participant_;
  TopicWatch& watch_;
  Round round_;
  Round previous_;
  bool follows_ = false;  // the previous round is of a tick before, in the same edition
  HeldCalls calls_;
  bool is_closed_ = false;
  bool is_shown_ = false;
  std::size_t held_bytes_ = 0;         // of the newest round
  std::optional<Told> told_;           // of the tick that is shown
  int tells_ = 0;                      // that are not answered; an edit may come before nodes know of a tick
  std::set<AgentEndpoints*> asked_;    // that have not shown the tick again yet, though it may be late for some
  std::set<std::string> late_topics_;  // that are written again, if they have been written for the tick
  Time asked_at_ = {};                 // the last time, or the start of the tick
  Time present_at_ = Time::max();      // since then the awaited programs are there
  // By program and service; null: DDS refuses one.
  std::map<std::pair<dds_instance_handle_t, std::string>, std::unique_ptr<NodeProbe>> probes_;
  bool is_probed_ = false;            // all awaited programs have answered
  Time probed_at_ = {};               // the newest of their answers
  Time show_again_at_ = Time::max();  // although no reader has come
  Clock::duration show_again_after_ = {};
  std::atomic<Clock::rep> reader_at_ = 0;  // when the newest has come
  std::optional<Time> due_;
};

}  // namespace troupe::ros
