// HeldCalls: calls of services by programs that a tick waits for. Two of them may call in one tick, and the order in
// which their calls arrive is that of the machine. So a call of a program that has not answered the tick waits until
// each participant has answered or has called, too; then all are passed on in the order of the callers' names. Calls of
// other programs, and of those that have answered, are passed on at once.
//
// A participant that waits for something else of one that has called would wait for ever: after some seconds calls are
// passed on in the order of their arrival.
//
// Add may be called on any thread, the others on that of the ParticipantServer.
#pragma once

#include <dds/dds.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/participant/topic_watch.h"

namespace troupe::ros {

class AgentEndpoints;

class HeldCalls {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Call {
    AgentEndpoints* agent;  // that has the service
    std::uint32_t service;
    dds_instance_handle_t caller;
    std::vector<std::byte> request;
  };

  explicit HeldCalls(TopicWatch& watch) : watch_(watch) {}

  void Add(Call call);
  void Remove(const AgentEndpoints& agent);
  // No call has arrived that was not passed on.
  bool IsEmpty();
  // Passes on what need not wait. `missing`: the topics and nodes that have not answered the tick that is shown; none:
  // no tick waits. `is_told`: the tick waits for just these; else it may wait for some of them. When it is to be called
  // again in any case.
  std::optional<Time> Update(std::set<std::string> missing, bool is_told, Time now);

 private:
  struct Waiting {
    Call call;
    std::string caller;  // a name of its program
    Time since;
  };

  static void Pass(const Call& call);
  // By which calls are put in order: what the program answers with, or the name of its node.
  std::string NameOf(dds_instance_handle_t program, const std::set<std::string>& watched) const;
  bool HaveAllAnsweredOrCalled(std::set<std::string> missing);

  TopicWatch& watch_;
  std::vector<Waiting> waiting_;
  std::mutex mutex_;
  std::vector<Call> arrived_;  // guarded by the mutex
};

}  // namespace troupe::ros
