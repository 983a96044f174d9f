// HostDomain: the participant of the host in one ROS domain. AgentEndpoints: the nodes and endpoints of one agent on
// it, as its messages ask for them.
// Both are used on the thread of the ParticipantServer alone, except for the functions that endpoints call on threads
// of DDS: these only add to the link, which is safe, and wake the server.
//
// A message that makes no sense ends the connection with a problem (Refuse): agents are of the same build, so it is a
// bug or an attack, and no state of it would be right.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "ros/connection/ros_participant.h"
#include "ros/link/link.h"
#include "ros/participant/cyclone_programs.h"
#include "ros/participant/reusable_endpoints.h"
#include "ros/participant/tick_gate.h"
#include "ros/participant/topic_watch.h"

namespace troupe::ros {

// EndpointPool<Endpoint>: detached endpoints, which are kept for a while for an agent that asks for the same again.
template <typename Endpoint>
class EndpointPool {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void Keep(std::string text, std::unique_ptr<Endpoint> endpoint, Time until) {
    kept_.emplace(std::move(text), Kept{std::move(endpoint), until});
  }
  // An endpoint that was kept with this text; null: none exists.
  std::unique_ptr<Endpoint> Acquire(const std::string& text) {
    const auto found = kept_.find(text);
    if (found == kept_.end()) return nullptr;
    std::unique_ptr<Endpoint> endpoint = std::move(found->second.endpoint);
    kept_.erase(found);
    return endpoint;
  }
  template <typename Visit>
  void VisitAll(Visit visit) {
    for (auto& [text, kept] : kept_) visit(*kept.endpoint);
  }
  void EndThoseUntil(Time now) {
    std::erase_if(kept_, [now](const auto& kept) { return kept.second.until <= now; });
  }

 private:
  struct Kept {
    std::unique_ptr<Endpoint> endpoint;
    Time until;
  };

  std::multimap<std::string, Kept> kept_;  // by text
};

// The endpoints that no agent has, of all kinds.
struct EndpointPools {
  EndpointPool<ReusableWriter> writers;
  EndpointPool<ReusableReader> readers;
  EndpointPool<ReusableService> services;

  void EndThoseUntil(std::chrono::steady_clock::time_point now) {
    writers.EndThoseUntil(now);
    readers.EndThoseUntil(now);
    services.EndThoseUntil(now);
  }
};

class AgentEndpoints;

struct HostDomain {
  // `side`: null if no clients on Fast DDS are served. `wake`: of ServeCycloneIfFound, called on any thread. Throws
  // dds::Exception when DDS cannot start.
  HostDomain(const RosNetwork& network, FastDdsSide* side, std::function<void()> wake)
      : number(network.domain),
        on_cyclone(side == nullptr),
        fast_dds(side),
        participant(network, "/", RosParticipant::Owner::kHost) {
    participant.WatchWriters();
    if (!on_cyclone && network.service_clients != ServiceClients::kFastDds) {
      cyclone_programs.emplace(participant, std::move(wake));
    }
  }

  // Arms the gate and the watch with the text of a tick. REQUIRES: they exist.
  void BeginRound(const std::string& text);

  // Serves clients on Cyclone DDS, too, once the domain has a program on it. Until then nothing on Cyclone stands
  // beside the services on Fast DDS: clients on Fast DDS from 2.14.6 and 3.2.3 on would match both, and could send a
  // first call to the one that does not understand it. Throws dds::Exception.
  void ServeCycloneIfFound();

  using Time = std::chrono::steady_clock::time_point;
  const std::uint32_t number;
  bool on_cyclone;  // services answer clients on Cyclone DDS
  FastDdsSide* const fast_dds;
  RosParticipant participant;
  std::optional<CyclonePrograms> cyclone_programs = {};  // while services wait for one
  EndpointPools pools;
  std::set<AgentEndpoints*> agents;
  TopicReaders readers;             // of agents
  std::optional<TopicWatch> watch;  // once ticks of the domain wait, as the two below
  std::optional<TickGate> gate;
  std::atomic<TickGate*> shared_gate = nullptr;  // the same, for threads of DDS
  AgentEndpoints* waiting = nullptr;             // the agent whose ticks wait; null: it has ended
  std::string frame_series;                      // of the text: the run and the edition, all but the tick
  bool has_new_readers = false;                  // since the last check
  Time announce_at = Time::max();                // the nodes have changed
  std::optional<Time> unused_until = {};         // it ends then; none: it has agents
};

class AgentEndpoints {
 public:
  // Returns the domain of an agent, which outlives it. May throw dds::Exception.
  using Join = std::function<HostDomain&(std::uint32_t domain)>;

  // Owns the descriptor of the connection. `wake` is called on any thread when Process has something to send.
  AgentEndpoints(Join join, int connection, std::function<void()> wake);
  ~AgentEndpoints();
  AgentEndpoints(const AgentEndpoints&) = delete;
  AgentEndpoints& operator=(const AgentEndpoints&) = delete;

  // Its services answer clients on Cyclone DDS from now on, too. Throws dds::Exception.
  void ServeCyclone();

  // Performs the messages that have arrived, and sends those that wait. False: the connection has ended, or must, for
  // the reason of problem().
  bool Process();
  // Empty: the agent has ended.
  const std::string& problem() const { return problem_; }
  bool has_output() const { return link_.pending() > 0; }
  // Null before the agent has named it.
  HostDomain* domain() const { return domain_; }
  // Whether its nodes have to be announced since the last call.
  bool ConsumeAnnouncement();
  // Whether it has a node.
  bool has_nodes() const { return !nodes_.empty(); }

  // Whether a reader of this agent is on the topic.
  bool Reads(const std::string& topic) const;
  bool watches_distributions() const { return watches_distributions_; }
  // A line for the agent's log.
  void Report(const std::string& line);

  // Of its readers.
  void BeginRound(bool is_new_run);

  // Passes the request to one of its services on.
  void SendRequest(std::uint32_t service, std::span<const std::byte> request) {
    Send(LinkKind::kSample, service, request);
  }
  // Calls of the TickGate.
  // Writes a sample of one of its writers, if that still exists.
  void WriteSample(std::uint32_t id, std::span<const std::byte> bytes);
  // Writes /world/tick with this list of topics, for so many messages kTell, each of which has its answer.
  void Announce(const TickGate::Announcement& announcement, const std::string& topics, int tells);
  void SendCalling(const std::set<std::uint32_t>& calling);
  // Whether its ticks wait.
  bool tells() const { return domain_ != nullptr && domain_->waiting == this; }
  void SendHeld(const std::set<std::uint32_t>& absent);
  // Asks the agents of the domain that show ticks to show theirs again; returns them.
  std::set<AgentEndpoints*> AskToShow();

 private:
  // With the text by which another agent finds it.
  template <typename Endpoint>
  struct Used {
    std::string text;
    std::unique_ptr<Endpoint> endpoint;
  };
  template <typename Endpoint>
  using ById = std::map<std::uint32_t, Used<Endpoint>>;

  void Perform(const LinkMessage& message);
  void Watch(std::uint32_t id, const std::string& watched);
  void PrepareToWait();
  // Performs what the other agents have sent by now.
  void Collect();
  // Performs what has been sent by now, unless it is being performed.
  void ProcessUnread();
  void Tell(const LinkMessage& message);
  void Make(std::uint32_t id, const MadeText& made);
  void MakeNode(std::uint32_t id, const std::string& name);
  void MakeWriter(std::uint32_t id, std::size_t node, const MadeText& made);
  void MakeReader(std::uint32_t id, std::size_t node, const MadeText& made);
  void MakeService(std::uint32_t id, std::size_t node, const MadeText& made);
  void Remove(std::uint32_t id);
  // Calls of the service that wait for participants are for the next agent.
  void ReturnCalls(std::uint32_t service);
  // A sample of a writer, or a response of a service.
  void Write(const LinkMessage& message);
  const dds_topic_descriptor_t* TypeOf(const std::string& name);
  // From any thread. Drops the message if the agent reads too slowly.
  void Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content = {});
  void Refuse(const std::string& problem);

  const Join join_;
  HostDomain* domain_ = nullptr;
  Link link_;
  const std::function<void()> wake_;
  std::string problem_;
  bool must_announce_ = false;
  bool watches_distributions_ = false;
  bool shows_ticks_ = false;
  bool is_processing_ = false;
  std::set<std::uint32_t> awaited_;             // watches, of the next Tell
  std::map<std::uint32_t, std::size_t> nodes_;  // of the participant
  ById<ReusableWriter> writers_;
  std::set<std::uint32_t> logs_;  // the writers of log lines
  ById<ReusableReader> readers_;
  ById<ReusableService> services_;
};

}  // namespace troupe::ros
