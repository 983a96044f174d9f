// ParticipantServer: the participant of a host in a ROS domain, and the agents that use it, each over a connection.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/wake_event.h"
#include "ros/connection/ros_participant.h"
#include "ros/messages/ros_options.h"
#include "ros/participant/agent_endpoints.h"

namespace troupe::ros {

class ParticipantServer {
 public:
  // Owns the listening socket. `stop` ends Run from any thread. `report`: receives problems, one line each. Throws
  // dds::Exception when DDS cannot start, and std::runtime_error without other resources.
  ParticipantServer(const RosOptions& options, int listening, const WakeEvent& stop,
                    std::function<void(const std::string&)> report);
  ~ParticipantServer();
  ParticipantServer(const ParticipantServer&) = delete;
  ParticipantServer& operator=(const ParticipantServer&) = delete;

  // Serves agents until the stop event.
  void Run();

 private:
  using Clock = std::chrono::steady_clock;

  void AcceptAgents();
  void AwaitDescriptors();
  void Process(int connection);
  // As epoll_ctl. False: it failed.
  bool Watch(int operation, int descriptor, std::uint32_t events) const;
  // Whether the agent has something to send may have changed.
  void WatchOutput(int connection, const AgentEndpoints& agent) const;
  void AnnounceIfDue();
  void CheckIfDue();
  void PassMismatches();
  void PassLastSamples();
  int WaitMilliseconds() const;

  const WakeEvent& stop_;
  const WakeEvent wake_;  // an agent has output
  const std::function<void(const std::string&)> report_;
  const int listening_;
  RosParticipant participant_;
  int events_ = -1;  // of epoll
  EndpointPools pools_;
  bool has_new_readers_ = false;                              // since the last check
  bool lacks_descriptors_ = false;                            // no agent can be accepted before the next check
  std::map<int, std::unique_ptr<AgentEndpoints>> agents_;     // by descriptor
  Clock::time_point announce_at_ = Clock::time_point::max();  // the nodes have changed
  Clock::time_point check_at_;                                // for mismatches and endpoints without an agent
};

}  // namespace troupe::ros
