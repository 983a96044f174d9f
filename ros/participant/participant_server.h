// ParticipantServer: the participants of a host in ROS domains, one in each, and the agents that use them, each over a
// connection.
//
// One thread (Run) waits for all sockets by epoll and performs all messages, so that the state of agents needs no lock;
// threads of DDS only put messages into links and wake it. It waits for no agent: a link that does not empty drops
// samples.
//
// The list of all nodes is one sample of DDS, so changes of the nodes are joined and announced together after some
// milliseconds, more with more agents: a thousand agents that start make a few lists, not a thousand lists of up to a
// thousand nodes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/base/wake_event.h"
#include "ros/connection/ros_participant.h"
#include "ros/messages/ros_options.h"
#include "ros/participant/agent_endpoints.h"

namespace troupe::ros {

class ParticipantServer {
 public:
  // `kWhileUsed`: Run returns as soon as the last connection has ended, or without a first one after some seconds.
  enum class Serving : std::uint8_t { kAlways, kWhileUsed };

  // Makes the participant in the domain of the network, which it keeps; those in other domains last as long as agents
  // use them. Listens at the bound socket as
  // soon as that is made, and owns it. `stop` ends Run from any thread. `report`: receives problems, one line each.
  // Throws dds::Exception when DDS cannot start, and std::runtime_error without other resources.
  ParticipantServer(const RosNetwork& network, int listening, Serving serving, const WakeEvent& stop,
                    std::function<void(const std::string&)> report);
  ~ParticipantServer();
  ParticipantServer(const ParticipantServer&) = delete;
  ParticipantServer& operator=(const ParticipantServer&) = delete;

  // Serves agents until the stop event, or as `serving` says.
  void Run();

 private:
  using Clock = std::chrono::steady_clock;

  HostDomain& Join(std::uint32_t domain);
  void AcceptAgents();
  void AwaitDescriptors();
  void Process(int connection);
  // As epoll_ctl. False: it failed.
  bool Watch(int operation, int descriptor, std::uint32_t events) const;
  // Whether the agent has something to send may have changed.
  void WatchOutput(int connection, const AgentEndpoints& agent);
  void AnnounceIfDue();
  void CheckIfDue();
  void PassMismatches(HostDomain& domain);
  void ProcessFastDds();
  void ServeCycloneIfFound(HostDomain& domain);
  void UpdateGate(HostDomain& domain);
  bool IsUnused() const;
  void PassLastSamples();
  int WaitMilliseconds() const;

  const WakeEvent& stop_;
  const WakeEvent wake_;  // an agent has output
  const std::function<void(const std::string&)> report_;
  const RosNetwork network_;
  std::unique_ptr<FastDdsSide> fast_dds_;  // null: no clients on Fast DDS are served
  int watched_side_ = -1;                  // its descriptor
  const Serving serving_;
  const int listening_;
  const Clock::time_point started_ = Clock::now();
  bool had_agents_ = false;
  int events_ = -1;                                        // of epoll
  bool lacks_descriptors_ = false;                         // no agent can be accepted before the next check
  std::map<std::uint32_t, HostDomain> domains_;            // by number
  std::map<int, std::unique_ptr<AgentEndpoints>> agents_;  // by descriptor
  std::set<int> writing_;                                  // connections that are watched for room to write
  Clock::time_point check_at_;                             // for mismatches, and for what no agent uses
};

}  // namespace troupe::ros
