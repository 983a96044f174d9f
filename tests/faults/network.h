// Network: the processes of a simulated run and the messages between the service and its agents, with faults, as DDS
// would deliver them: an expired lease is reported, a process that is discovered (again) receives the retained message
// of the other, and no other message passes between two processes unless each has discovered the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "tests/faults/fault_plan.h"
#include "troupe/random.h"

namespace troupe::faults {

// EventQueue: calls in the order of their virtual times, s. Calls for the same time are made in the order of At.
class EventQueue {
 public:
  double now() const { return now_; }
  std::size_t size() const { return events_.size(); }

  void At(double time, std::function<void()> call) {
    events_.push_back({std::max(time, now_), next_++, std::move(call)});
    std::push_heap(events_.begin(), events_.end(), IsLater);
  }
  void After(double seconds, std::function<void()> call) { At(now_ + seconds, std::move(call)); }

  // Makes the next call, unless its time is after `end`: then now() is `end`, and the result false.
  bool Advance(double end) {
    if (events_.empty() || events_.front().time > end) {
      now_ = std::max(now_, end);
      return false;
    }
    std::pop_heap(events_.begin(), events_.end(), IsLater);
    const Event event = std::move(events_.back());
    events_.pop_back();
    now_ = event.time;
    event.call();
    return true;
  }

 private:
  struct Event {
    double time = 0.0;
    std::uint64_t number = 0;
    std::function<void()> call;
  };
  static bool IsLater(const Event& a, const Event& b) {
    return a.time != b.time ? a.time > b.time : a.number > b.number;
  }

  double now_ = 0.0;
  std::uint64_t next_ = 0;
  std::vector<Event> events_;  // a heap
};

// RandomSource: the random numbers of a seed.
class RandomSource {
 public:
  RandomSource(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  double Uniform(double min, double max) { return min + (max - min) * RandomUniform({seed_, stream_, draws_++}); }
  bool Chance(double probability) { return probability > 0.0 && Uniform(0.0, 1.0) < probability; }
  // From 0 to count - 1.
  std::size_t Index(std::size_t count) { return RandomBits({seed_, stream_, draws_++}) % count; }

 private:
  std::uint64_t seed_;
  std::uint64_t stream_;
  std::uint64_t draws_ = 0;
};

using ProcessId = std::uint64_t;  // also the AgentId of an agent
inline constexpr ProcessId kService = 0;

class Network {
 public:
  // The calls that one process receives from the network about the other end.
  struct Handlers {
    std::function<void()> on_discovered;  // the retained message of the other end is to be delivered
    std::function<void()> on_open;        // messages pass again that did not for less than a lease
    std::function<void()> on_lost;        // its lease has expired
    std::function<void()> on_ended;       // it has ended in order
  };

  Network(EventQueue& events, const MessageFaults& faults, double lease, std::uint64_t seed)
      : events_(events), faults_(faults), lease_(lease), random_(seed, 2) {}

  // `at_agent` is called for the service's presence, `at_service` for the agent's.
  void AddAgent(ProcessId agent, Handlers at_agent, Handlers at_service);

  // A process that does not run makes no calls; those for a stopped one are made when it continues.
  bool IsRunning(ProcessId process) const { return !states_.contains(process); }
  bool HasEnded(ProcessId process) const;
  void Stop(ProcessId process);
  void Continue(ProcessId process);
  void Kill(ProcessId process);
  void End(ProcessId process);  // in order
  // Another process takes the place of the service, which has ended: the agents discover it, some of them after the
  // lease of the one before has expired.
  void ReplaceService();
  // Blocks the messages to or from an agent. Partitions of one direction are counted.
  void BlockToAgent(ProcessId agent, bool blocked);
  void BlockFromAgent(ProcessId agent, bool blocked);

  // Calls `receive` inside the process: after a delay, perhaps several times or never. A message that waits for a
  // stopped process may be received after the news of its sender's end.
  void Send(ProcessId from, ProcessId to, const std::function<void()>& receive);
  // The same, but never received after such news: that of messages which are on one topic with it.
  void SendWithPresence(ProcessId from, ProcessId to, const std::function<void()>& receive);
  // The same as the latter without faults but the delay, in the order of the calls, if the two are connected now. False
  // if not.
  bool SendIntact(ProcessId from, ProcessId to, const std::function<void()>& receive);
  // Calls inside the process, now or when it continues. Nothing happens if it has ended.
  void RunInside(ProcessId process, std::function<void()> call);

  RandomSource& random() { return random_; }
  std::size_t most_waiting() const { return most_waiting_; }  // calls for a stopped process

 private:
  enum class State : std::uint8_t { kStopped, kEnded };
  // What one end knows of the other.
  struct View {
    bool connected = false;
    bool open = false;        // messages from the other end pass
    int blocked = 0;          // partitions of the messages from the other end
    std::uint64_t epoch = 0;  // of the last change of the path
    Handlers handlers;
    double in_order_at = 0.0;  // of the last intact message
  };
  struct Link {
    View at_agent;
    View at_service;
  };

  // Messages from -> to pass.
  bool IsOpen(ProcessId from, ProcessId to) const;
  View& ViewOf(ProcessId from, ProcessId to);  // that `to` has of `from`
  const View& ViewOf(ProcessId from, ProcessId to) const { return const_cast<Network*>(this)->ViewOf(from, to); }
  // A process or a partition changed the path.
  void Update(ProcessId from, ProcessId to);
  void UpdateAll(ProcessId process);
  // Expires the leases of the other ends, for a process that was stopped.
  void ExpireLeasesOf(ProcessId process);
  void Discover(ProcessId agent);
  std::function<void()> IfConnected(ProcessId from, ProcessId to, const std::function<void()>& receive);
  void Deliver(ProcessId from, ProcessId to, double delay, const std::function<void()>& receive);

  EventQueue& events_;
  const MessageFaults faults_;
  const double lease_;
  RandomSource random_;
  std::map<ProcessId, Link> links_;    // by agent
  std::map<ProcessId, State> states_;  // of processes that do not run
  std::map<ProcessId, double> stopped_at_;
  std::map<ProcessId, std::vector<std::function<void()>>> waiting_;
  std::size_t most_waiting_ = 0;
};

}  // namespace troupe::faults
