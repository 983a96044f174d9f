// HeldCalls: calls of services by programs that a tick waits for. Several of them may call in one tick, and the order
// in which their calls arrive is that of the machine. So a call of a program that has not answered the tick waits until
// each participant has answered, has called, or has said that it makes no call before others'; then all are passed on
// in the order of the callers' names. No time ends the wait: a call that is late would then be executed behind another
// one. Calls of other programs, and of those that have answered, are passed on at once.
//
// A name is that of the participant: what the program writes that is watched. A program that has not answered yet is
// taken for the participant with the name of one of its nodes, or for one that has never been heard of.
//
// Add may be called on any thread, the others on that of the ParticipantServer.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "ros/participant/topic_watch.h"

namespace troupe::ros {

class AgentEndpoints;

class HeldCalls {
 public:
  struct Call {
    AgentEndpoints* agent;  // that has the service
    std::uint32_t service;
    dds_instance_handle_t caller;
    std::vector<std::byte> request;
  };
  // The tick whose text is armed.
  struct Tick {
    std::set<std::string> missing;  // the topics and nodes that have not answered it; none: no tick waits
    std::set<std::string> waiting;  // those among them that make no call before others
    bool is_told = false;           // it waits for just these; else it may wait for some of them
  };

  explicit HeldCalls(TopicWatch& watch) : watch_(watch) {}

  void Add(Call call);
  // The calls of the agent's service that were not passed on, in the order of their arrival.
  std::vector<Call> Take(const AgentEndpoints& agent, std::uint32_t service);
  // No call has arrived that was not passed on.
  bool IsEmpty();
  // Passes on what need not wait. Returns the participants whose calls wait.
  std::set<std::string> Update(const Tick& tick);

 private:
  // A program that has called: the participants in it, as far as they are known.
  struct Caller {
    std::set<std::string> participants;
    std::string name;  // by which its calls are put in order
  };
  using Callers = std::map<dds_instance_handle_t, Caller>;

  static void Pass(const Call& call);
  bool IsAwaited(const Call& call, const Tick& tick);
  Callers FindCallers(const std::set<std::string>& missing);
  // The participants of programs that may be a node and have not answered yet.
  void FindUnknown(std::set<std::string> missing, const std::set<dds_instance_handle_t>& programs, Callers& callers);

  TopicWatch& watch_;
  std::vector<Call> waiting_;
  std::mutex mutex_;
  std::vector<Call> arrived_;  // guarded by the mutex
};

}  // namespace troupe::ros
